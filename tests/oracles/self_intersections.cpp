// Counts the pairs of triangles of a surface that meet improperly, with CGAL; the test's oracle, no part of the program.
// Input on stdin: number of points, number of triangles, the coordinates, the vertex ids. Output: the pairs, ascending,
// one a line. The triangles have to be an oriented manifold (isolated triangles are one); else the exit code is 2.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <utility>
#include <vector>

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Face = Mesh::Face_index;

int main() {
    std::size_t points_count = 0, triangles_count = 0;
    if (std::scanf("%zu %zu", &points_count, &triangles_count) != 2) return 1;
    std::vector<Kernel::Point_3> points;
    for (std::size_t i = 0; i < points_count; ++i) {
        double x, y, z;
        if (std::scanf("%la %la %la", &x, &y, &z) != 3) return 1;
        points.emplace_back(x, y, z);
    }
    std::vector<std::array<std::size_t, 3>> triangles(triangles_count);
    for (auto &t : triangles)
        if (std::scanf("%zu %zu %zu", &t[0], &t[1], &t[2]) != 3) return 1;
    if (!PMP::is_polygon_soup_a_polygon_mesh(triangles)) return 2;
    Mesh mesh;
    PMP::polygon_soup_to_polygon_mesh(points, triangles, mesh);
    std::vector<std::pair<Face, Face>> found;
    PMP::self_intersections(mesh, std::back_inserter(found));
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto &f : found) pairs.emplace_back(std::min<std::size_t>(f.first, f.second), std::max<std::size_t>(f.first, f.second));
    std::sort(pairs.begin(), pairs.end());
    for (const auto &p : pairs) std::printf("%zu %zu\n", p.first, p.second);
    return 0;
}
