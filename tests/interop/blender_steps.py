# Run inside Blender by blender_files.sh: loads lit.vdb and lit.ply and says what came.
import os

import bpy

here = os.getcwd()
bpy.ops.object.volume_import(filepath=here + "/lit.vdb", files=[{"name": "lit.vdb"}], directory=here)
cells = bpy.context.object
cells.data.grids.load()
for grid in cells.data.grids:
    matrix = grid.matrix_object
    print("found", grid.name, grid.data_type, "size %.3f" % matrix[0][0],
          "at %.3f %.3f %.3f" % tuple(matrix[k][3] for k in range(3)))


def surface(threshold):
    """Corners of the surface on which a density lies."""
    mesh = bpy.data.objects.new("surface", bpy.data.meshes.new("surface"))
    bpy.context.collection.objects.link(mesh)
    modifier = mesh.modifiers.new("surface", "VOLUME_TO_MESH")
    modifier.object, modifier.threshold = cells, threshold
    graph = bpy.context.evaluated_depsgraph_get()
    return [v.co.copy() for v in mesh.evaluated_get(graph).to_mesh().vertices]


# The floor of 5 to 6.9 by 7 to 8.9, in cells of an eighth of a metre, and a cell around it.
corners = surface(0.1)
print("found the floor" if corners and all(4.8 < v.x < 7.1 and 6.8 < v.y < 9.1 and 12.1 < v.z < 12.6
                                          for v in corners) else "found something elsewhere")
print("found no density over 1" if not surface(1.001) else "found a density over 1")

# Blender tells that a grid holds points and names it; it has no use for them yet.
bpy.ops.object.volume_import(filepath=here + "/points.vdb", files=[{"name": "points.vdb"}],
                             directory=here)
grids = bpy.context.object.data.grids
grids.load()
print("found beside them", [grid.name for grid in grids if grid.data_type == "POINTS"],
      grids.error_message or "without complaint")

bpy.ops.import_mesh.ply(filepath=here + "/lit.ply")
points = [v.co for v in bpy.context.object.data.vertices]
places = [(5 + i % 20 * 0.1, 7 + i // 20 * 0.1, 12.25 + 0.01 * (i % 3)) for i in range(400)]
# Single precision: 2^-24 of 12.3 m, rounded twice.
off = max(abs(p[k] - q[k]) for p, q in zip(points, places) for k in range(3))
print("found %d points" % len(points), "in place" if off < 2e-6 else "off by %g m" % off)
