"""
Voronoi cells in a domain
=========================

Districts of the nearest site, cut at the coast of a country with a lake and an island: each is a
polygon, perhaps of several parts, and their areas add up to that of the domain.
"""

import matplotlib.pyplot as plt
import numpy as np
import shapely

import liftmesh

turn = np.linspace(0, 2 * np.pi, 300, endpoint=False)
shore = np.column_stack([1.3 * np.cos(turn), np.sin(turn)])
land = shapely.Polygon(shore * (4 + 0.5 * np.sin(3 * turn) + 0.2 * np.sin(11 * turn))[:, None])
lake = shapely.Point(-1.6, 0.8).buffer(1.0)
country = shapely.union_all([land - lake, shapely.Point(-1.6, 0.8).buffer(0.4)])
drawn = np.random.default_rng(4).uniform(-5, 5, (90, 2))
sites = drawn[shapely.contains_xy(country, *drawn.T)]

cells = liftmesh.voronoi(sites, domain=country)
figure, ax = plt.subplots(figsize=(7.5, 5.5))
for shape, area in zip(cells.to_shapely(), cells.areas, strict=True):
    for part in shapely.get_parts(shape):
        tint = plt.get_cmap("YlGnBu")(0.1 + area / cells.areas.max() / 2)
        ax.fill(*part.exterior.xy, facecolor=tint, edgecolor="#33576b", linewidth=0.8)
ax.scatter(*sites.T, s=8, color="#b4432f", zorder=3)
ax.set_title(f"areas add up to {cells.areas.sum():.12f} of {country.area:.12f}")
ax.set_aspect("equal")
ax.set_axis_off()
plt.show()
