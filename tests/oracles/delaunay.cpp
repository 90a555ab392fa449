// The Delaunay tetrahedralization of points, by CGAL; the tests' oracle, no part of the program.
// Input on stdin: number of points, coordinates. Output: number of tetrahedra, volume of the convex hull, and the
// tetrahedra's vertex ids, ascending in each and all in lexicographic order, one a line.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_3<unsigned, Kernel>;
using Cell = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell>>;

int main() {
    std::size_t count = 0;
    if (std::scanf("%zu", &count) != 1) return 1;
    std::vector<std::pair<Kernel::Point_3, unsigned>> points;
    for (std::size_t i = 0; i < count; ++i) {
        double x, y, z;
        if (std::scanf("%la %la %la", &x, &y, &z) != 3) return 1;
        points.emplace_back(Kernel::Point_3(x, y, z), unsigned(i));
    }
    Delaunay delaunay(points.begin(), points.end());
    double volume = 0;
    std::vector<std::array<unsigned, 4>> tets;
    for (auto cell = delaunay.finite_cells_begin(); cell != delaunay.finite_cells_end(); ++cell) {
        std::array<unsigned, 4> t;
        for (int i = 0; i < 4; ++i) t[i] = cell->vertex(i)->info();
        std::sort(t.begin(), t.end());
        tets.push_back(t);
        volume += delaunay.tetrahedron(cell).volume();
    }
    std::sort(tets.begin(), tets.end());
    std::printf("%zu %.17g\n", tets.size(), volume);
    for (const auto &t : tets) std::printf("%u %u %u %u\n", t[0], t[1], t[2], t[3]);
    return 0;
}
