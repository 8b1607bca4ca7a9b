#pragma once

// GLSL's names for C++, so that one *.shared.h serves both. Structures use layout(scalar): members
// of 4 bytes without padding, matrices as columns.

#include <glm/mat2x2.hpp>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace gnomon::gpu::shared {
using glm::mat2;
using glm::mat4;
using glm::mat4x3;
using glm::uvec2;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
}  // namespace gnomon::gpu::shared
