"""Keywords of PyPI's ``tetgen`` that change nothing here, or that are refused."""

from typing import Any, TypedDict


class RefusedOptions(TypedDict, total=False):
    """Keywords that ask for another result: each is refused unless it has its default."""

    psc: Any
    refine: Any
    cdt: Any
    coarsen: Any
    weighted: Any
    metric: Any
    insertaddpoints: Any
    convex: Any
    voroout: Any
    bgmesh: Any
    bgmeshfilename: Any
    coarsen_percent: Any
    metric_scale: Any
    elem_growth_ratio: Any


class IgnoredOptions(TypedDict, total=False):
    """Keywords that tune algorithms of TetGen."""

    brio_hilbert: Any
    flipinsert: Any
    diagnose: Any
    noexact: Any
    nostaticfilter: Any
    zeroindex: Any
    neighout: Any
    meditview: Any
    vtkview: Any
    vtksurfview: Any
    nobound: Any
    nonodewritten: Any
    noelewritten: Any
    nofacewritten: Any
    noiterationnum: Any
    docheck: Any
    quiet: Any
    nowarning: Any
    verbose: Any
    vertexperblock: Any
    tetrahedraperblock: Any
    shellfaceperblock: Any
    supsteiner_level: Any
    addsteiner_algo: Any
    cdtrefine: Any
    coarsen_param: Any
    weighted_param: Any
    fliplinklevel: Any
    flipstarsize: Any
    fliplinklevelinc: Any
    opt_max_flip_level: Any
    opt_scheme: Any
    opt_iterations: Any
    smooth_cirterion: Any
    smooth_maxiter: Any
    delmaxfliplevel: Any
    reversetetori: Any
    steinerleft: Any
    unflip_queue_limit: Any
    no_sort: Any
    hilbert_order: Any
    hilbert_limit: Any
    brio_threshold: Any
    brio_ratio: Any
    opt_max_asp_ratio: Any
    opt_max_edge_ratio: Any
    optmaxdihedral: Any
    smooth_alpha: Any
    refine_progress_ratio: Any
    maxvolume_length: Any
    nomergefacet: Any
    nomergevertex: Any
    nojettison: Any
    epsilon: Any
    facet_separate_ang_tol: Any
    collinear_ang_tol: Any
    facet_small_ang_tol: Any


class TetGenOptions(RefusedOptions, IgnoredOptions, total=False):
    """Keywords of ``TetGen.tetrahedralize`` without an effect here."""
