// One scene made of arbitrary bytes, loaded as the program would and judged: what libFuzzer calls, and what
// replays its corpus without it.
#pragma once

#include <span>
#include <string_view>

#include "render/core/names.h"

namespace twopass {

/// How the bytes become files. A zero byte ends the first file where a second is named.
enum class FuzzFormat {
  xml,  ///< a Mitsuba scene; second: part.xml, which it may include. Beside them: mesh.obj mesh.ply light.ies
        ///< picture.exr
  obj,  ///< an OBJ file; second: its library scene.mtl. Beside them: picture.exr
  ply,  ///< a mesh of a Mitsuba scene
  serialized,  ///< a mesh of a Mitsuba scene, whose first two shapes are used
  gltf         ///< .glb where the bytes begin as one, else .gltf; second: data.bin. Beside them: picture.exr
};

inline constexpr Named<FuzzFormat> fuzz_format_names[] = {
    {"xml", FuzzFormat::xml},   {"obj", FuzzFormat::obj},
    {"ply", FuzzFormat::ply},   {"serialized", FuzzFormat::serialized},
    {"gltf", FuzzFormat::gltf},
};

/// Writes the files into a folder that lives as long as the process, loads the scene, builds it and casts rays.
/// Ends the process by abort(), with a line on stderr, unless the scene is as SceneDescription promises or is
/// refused by an Error of one line, within the memory that `memory_allowance` states.
void run_fuzz_case(FuzzFormat format, std::string_view bytes);

/// Bytes that loading a scene of files of `size` bytes in all may take at its peak.
std::size_t memory_allowance(FuzzFormat format, std::size_t size);

}  // namespace twopass
