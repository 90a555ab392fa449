"""Keyword arguments of each function."""

from .common import ConfigOptions, MemoryOptions, OrderOptions, PageOptions, ThreadOptions
from .files import CapOptions, FileOptions, RegionFileOptions
from .filling import ComplexOptions, FillingOptions
from .flow import FlowOptions
from .growth import GrowthOptions
from .domain import DomainOptions
from .layers import LayerOptions, PartialLayerOptions
from .models import ModelOptions
from .picture import FaultOptions, PictureOptions
from .preparation import PreparationOptions
from .reading import ReadingOptions
from .refinement import IterationOptions, RefinementOptions
from .resolution import ResolutionOptions
from .run import FidelityOptions, RootOptions, RunOptions, WorkOptions


class MeshOptions(
    ReadingOptions,
    OrderOptions,
    ResolutionOptions,
    LayerOptions,
    DomainOptions,
    RootOptions,
    FlowOptions,
    PreparationOptions,
    RefinementOptions,
    FidelityOptions,
    RunOptions,
    WorkOptions,
    PageOptions,
    ThreadOptions,
    ConfigOptions,
    total=False,
):
    """Keyword arguments of ``mesh``, ``estimate`` and ``mesh_shard``."""


class NetworkFlowOptions(
    ReadingOptions,
    ModelOptions,
    RootOptions,
    FlowOptions,
    PreparationOptions,
    RefinementOptions,
    ThreadOptions,
    ConfigOptions,
    total=False,
):
    """Keyword arguments of ``flow``."""


class SurfaceOptions(
    ReadingOptions,
    ResolutionOptions,
    CapOptions,
    PreparationOptions,
    RefinementOptions,
    ThreadOptions,
    ConfigOptions,
    total=False,
):
    """Keyword arguments of ``surface``."""


class PrepareOptions(ReadingOptions, PreparationOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``prepare``."""


class RefineOptions(
    ReadingOptions,
    IterationOptions,
    RefinementOptions,
    PreparationOptions,
    FidelityOptions,
    PageOptions,
    ThreadOptions,
    ConfigOptions,
    total=False,
):
    """Keyword arguments of ``refine``."""


class NetworkOptions(ReadingOptions, ConfigOptions, total=False):
    """Keyword arguments of ``dual`` and ``info``."""


class GenerateOptions(GrowthOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``generate``."""


class CheckSurfaceOptions(ComplexOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``check_surface``."""


class TetrahedralizeOptions(
    OrderOptions,
    FillingOptions,
    LayerOptions,
    PartialLayerOptions,
    ComplexOptions,
    PageOptions,
    ThreadOptions,
    ConfigOptions,
    total=False,
):
    """Keyword arguments of ``tetrahedralize``."""


class CheckOptions(MemoryOptions, PageOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``check``."""


class ConvertOptions(FileOptions, CapOptions, RegionFileOptions, MemoryOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``convert`` and of ``save``."""


class RenderOptions(PictureOptions, ReadingOptions, MemoryOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``render``."""


class ViewOptions(FaultOptions, ReadingOptions, ThreadOptions, ConfigOptions, total=False):
    """Keyword arguments of ``view``."""
