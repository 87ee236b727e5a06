# In Blender, headless, the recipe of render/image/README.md: a socket for each layer, the light layers added up by Mix
# nodes, a Cryptomatte node for each object. Arguments behind --: PICTURE.exr OUTPUT_FOLDER OBJECT ...
import sys

import bpy

picture, folder, *objects = sys.argv[sys.argv.index("--") + 1:]
scene = bpy.context.scene
scene.use_nodes = True
scene.render.engine = "BLENDER_WORKBENCH"
tree = scene.node_tree
tree.nodes.clear()
image = bpy.data.images.load(picture)
image.colorspace_settings.name = "Linear"
scene.render.resolution_x, scene.render.resolution_y = image.size
scene.render.resolution_percentage = 100
reader = tree.nodes.new("CompositorNodeImage")
reader.image = image
print("sockets:", " ".join(socket.name for socket in reader.outputs if socket.enabled))

files = tree.nodes.new("CompositorNodeOutputFile")
files.base_path = folder
files.format.file_format = "OPEN_EXR"
files.format.color_depth = "32"


def write(name, socket):
    files.file_slots.new(name)
    tree.links.new(socket, files.inputs[name])


def named(name):
    return next(socket for socket in reader.outputs if socket.name == name)


beauty = next(socket for socket in reader.outputs if socket.name in ("Combined", "Image"))
light = [named(a + "_" + b) for a in ("diffuse", "specular", "transmission") for b in ("direct", "indirect")]
light += [named("emission"), named("background")]
total = light[0]
for socket in light[1:]:
    mix = tree.nodes.new("CompositorNodeMixRGB")
    mix.blend_type = "ADD"
    tree.links.new(total, mix.inputs[1])
    tree.links.new(socket, mix.inputs[2])
    total = mix.outputs[0]
files.file_slots.clear()
write("beauty_", beauty)
write("sum_", total)
alpha = tree.nodes.new("CompositorNodeSepRGBA")
tree.links.new(beauty, alpha.inputs[0])
write("alpha_", alpha.outputs["A"])
coverage = None
for name in objects:
    matte = tree.nodes.new("CompositorNodeCryptomatteV2")
    matte.source = "IMAGE"
    matte.image = image
    matte.matte_id = name
    if name == objects[0]:
        write("matte_", matte.outputs["Matte"])
    if coverage is None:
        coverage = matte.outputs["Matte"]
        continue
    add = tree.nodes.new("CompositorNodeMath")
    tree.links.new(coverage, add.inputs[0])
    tree.links.new(matte.outputs["Matte"], add.inputs[1])
    coverage = add.outputs[0]
write("coverage_", coverage)
composite = tree.nodes.new("CompositorNodeComposite")
tree.links.new(total, composite.inputs[0])
scene.camera = bpy.data.objects.get("Camera")
bpy.ops.render.render()
