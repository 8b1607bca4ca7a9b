#include "fuzz_files.h"
#include "scene/gltf.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    gnomon::fuzz::load(gnomon::scene::load_gltf, {data, data + size}, gnomon::fuzz::FuzzFiles());
    return 0;
}
