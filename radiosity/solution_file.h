// Radiosity solutions in files, to be used again for other views of the same scene.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "radiosity/solution.h"

namespace twopass {

/// Writes the solution atomically. The file names the scene by its fingerprint, so it serves no other; and it
/// holds what a solution looks like (display_of_solution). `to_rec709`: of the scene's colours; `groups`: to be
/// kept with it. REQUIRES: a solution of the scene; groups on its elements. Throws Error when it cannot be
/// written.
void save_solution(const std::filesystem::path& path, const Scene& scene, const Solution& solution,
                   const ColorMatrix& to_rec709 = {}, const GroupedIrradiance& groups = {});

/// The same solution again, bit for bit, and the groups, if any. Throws Error when the file cannot be read, is
/// not a solution, is damaged (any single byte, any missing end), was written by another version of the
/// program, or belongs to another scene. REQUIRES: the scene outlives the solution.
Solution load_solution(const std::filesystem::path& path, const Scene& scene,
                       GroupedIrradiance* groups = nullptr);

/// A number that tells solutions apart: a hash of every element's irradiance. The same for a solution that was
/// saved and loaded.
std::uint64_t solution_fingerprint(const Solution& solution);

/// What a solution looks like, as binary glTF (glb_of), which takes no scene. Throws Error as load_solution
/// does.
std::vector<std::byte> display_of_solution(const std::filesystem::path& path);

/// The same to and from the bytes of a file; `where` stands for it in errors, `display` is kept as it is.
std::vector<std::byte> solution_to_bytes(const Scene& scene, const Solution& solution,
                                         const std::vector<std::byte>& display = {},
                                         const GroupedIrradiance& groups = {});
Solution solution_from_bytes(std::span<const std::byte> bytes, const Scene& scene,
                             const std::filesystem::path& where, GroupedIrradiance* groups = nullptr);

}  // namespace twopass
