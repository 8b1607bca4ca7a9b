#include "fuzz_files.h"
#include "scene/obj.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

// What follows the first byte 1 is the text of the material library.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::uint8_t* end = data + size;
    const std::uint8_t* split = std::find(data, end, std::uint8_t{1});
    const gnomon::fuzz::FuzzFiles files({std::min(split + 1, end), end});
    gnomon::fuzz::load(gnomon::scene::load_obj, {data, split}, files);
    return 0;
}
