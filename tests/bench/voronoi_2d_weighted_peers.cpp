// SPDX-License-Identifier: GPL-3.0-or-later
// Additively weighted Voronoi diagrams by CGAL, for comparison: `voronoi_2d_weighted_peers FILE`, the file holding
// triples of doubles: x, y, weight. Prints one line:
//   cgal SECONDS VISIBLE HIDDEN VERTICES EDGES
// Seconds of processor time for the Apollonius graph.

#include <CGAL/Apollonius_graph_filtered_traits_2.h>
#include <CGAL/Apollonius_graph_hierarchy_2.h>
#include <CGAL/MP_Float.h>
#include <CGAL/Simple_cartesian.h>
#include <cstdio>
#include <ctime>
#include <vector>

using Traits = CGAL::Apollonius_graph_filtered_traits_2<CGAL::Simple_cartesian<double>, CGAL::Field_with_sqrt_tag,
                                                        CGAL::Simple_cartesian<CGAL::MP_Float>,
                                                        CGAL::Integral_domain_without_division_tag>;
using Graph = CGAL::Apollonius_graph_hierarchy_2<Traits>;

static double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int main(int count, char** arguments) {
  std::FILE* file = count == 2 ? std::fopen(arguments[1], "rb") : nullptr;
  if (!file) return 1;
  std::vector<Graph::Site_2> sites;
  for (double row[3]; std::fread(row, sizeof(double), 3, file) == 3;)
    sites.emplace_back(Graph::Point_2(row[0], row[1]), row[2]);
  std::fclose(file);
  const double start = cpu_seconds();
  const Graph graph(sites.begin(), sites.end());
  const double seconds = cpu_seconds() - start;
  long vertices = 0, edges = 0;
  for (auto face = graph.finite_faces_begin(); face != graph.finite_faces_end(); ++face) ++vertices;
  for (auto edge = graph.finite_edges_begin(); edge != graph.finite_edges_end(); ++edge) ++edges;
  std::printf("cgal %.9f %zu %zu %ld %ld\n", seconds, static_cast<std::size_t>(graph.number_of_visible_sites()),
              static_cast<std::size_t>(graph.number_of_hidden_sites()), vertices, edges);
}
