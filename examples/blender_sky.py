"""Lights a Blender scene with a panorama of a sky.

    nephoscope pano fair_weather -o sky.exr --set sunshafts.strength=0
    blender scene.blend --python examples/blender_sky.py -- sky.exr

North of the sky is +Y, east +X, up +Z. The sun is in the picture, as bright as it is, so the world needs no sun lamp;
keep the EXR: 16 bits or a Radiance file would clip or coarsen its disc.
"""

import math
import sys

import bpy


def light_world_with(path, heading_deg=0.0):
    """Makes a panorama the world's light. `heading_deg` is the azimuth of its middle, the camera's heading."""
    scene = bpy.context.scene
    world = scene.world or bpy.data.worlds.new("Sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    image = bpy.data.images.load(path, check_existing=True)
    image.colorspace_settings.name = "Linear Rec.709"
    coordinates = nodes.new("ShaderNodeTexCoord")
    mapping = nodes.new("ShaderNodeMapping")
    # Blender's panorama has +X in its middle; the sky's has the heading there, clockwise from north, which is +Y.
    mapping.inputs["Rotation"].default_value[2] = math.radians(heading_deg - 90.0)
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    texture.projection = "EQUIRECTANGULAR"
    background = nodes.new("ShaderNodeBackground")
    output = nodes.new("ShaderNodeOutputWorld")
    links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs["Background"], output.inputs["Surface"])
    return world


if __name__ == "__main__" and "--" in sys.argv:
    light_world_with(*sys.argv[sys.argv.index("--") + 1 :][:1])
