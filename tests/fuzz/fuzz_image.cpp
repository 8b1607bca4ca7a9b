#include <gnomon/error.h>

#include "image/decode.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        (void)gnomon::image::decode({data, size}, "picture");
    } catch (const gnomon::Error&) {
    }
    return 0;
}
