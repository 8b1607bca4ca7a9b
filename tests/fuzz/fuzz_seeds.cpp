// fuzz_seeds FOLDER: writes the seeds of the fuzz targets into FOLDER/gltf, /obj and /image.
#include <gnomon/scene.h>

#include "base/file.h"
#include "image/decode.h"

#include <jpeglib.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using gnomon::image::Rgba8;

Rgba8 gradient(unsigned side) {
    Rgba8 picture{{side, side}, {}};
    for (unsigned y = 0; y < side; ++y) {
        for (unsigned x = 0; x < side; ++x) {
            for (const unsigned value : {16 * x, 16 * y, 8 * (x + y), 255 - 16 * x})
                picture.rgba.push_back(static_cast<std::uint8_t>(value));
        }
    }
    return picture;
}

std::string jpeg(unsigned side, bool progressive) {
    jpeg_compress_struct compressor{};
    jpeg_error_mgr errors{};
    compressor.err = jpeg_std_error(&errors);
    jpeg_create_compress(&compressor);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&compressor, &bytes, &size);
    compressor.image_width = compressor.image_height = side;
    compressor.input_components = 3;
    compressor.in_color_space = JCS_RGB;
    jpeg_set_defaults(&compressor);
    if (progressive) jpeg_simple_progression(&compressor);
    jpeg_start_compress(&compressor, TRUE);
    std::vector<JSAMPLE> row(std::size_t{3} * side);
    for (unsigned y = 0; y < side; ++y) {
        for (std::size_t i = 0; i < row.size(); ++i)
            row[i] = static_cast<JSAMPLE>(i * 5 + y * 9);
        JSAMPROW rows[] = {row.data()};
        jpeg_write_scanlines(&compressor, rows, 1);
    }
    jpeg_finish_compress(&compressor);
    jpeg_destroy_compress(&compressor);
    std::string result(reinterpret_cast<char*>(bytes), size);
    std::free(bytes);
    return result;
}

// Every feature that the loader reads, on accessors over a file of 4096 bytes.
constexpr const char* kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,3]}],
"extensionsUsed":["KHR_lights_punctual","EXT_mesh_gpu_instancing","KHR_texture_transform"],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{"innerConeAngle":0.1},
"color":[1,0.5,0],"intensity":2}]}},
"nodes":[{"mesh":0,"skin":0,"children":[1,2]},{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1],"camera":0},
{"mesh":0,"rotation":[0,0,0.6,0.8],"weights":[0.5],"extensions":{"KHR_lights_punctual":{"light":0}}},
{"mesh":0,"scale":[1,-2,1],"translation":[1,2,3],
"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0,"ROTATION":6}}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
"meshes":[{"weights":[0.25],"primitives":[{"mode":5,"indices":1,"material":0,"attributes":{"POSITION":0,
"NORMAL":0,"TEXCOORD_0":2,"COLOR_0":3,"JOINTS_0":4,"WEIGHTS_0":3},"targets":[{"POSITION":5}]}]}],
"materials":[{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0,
"extensions":{"KHR_texture_transform":{"offset":[0.1,0.2],"scale":[2,3],"rotation":1,"texCoord":0}}}}}],
"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],
"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNk+A8AAQUBAScY42YAAAAASUVORK5CYII="}],
"skins":[{"joints":[1,2],"inverseBindMatrices":7}],
"animations":[{"samplers":[{"input":8,"output":9,"interpolation":"CUBICSPLINE"},{"input":8,"output":8}],
"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}},{"sampler":1,"target":{"node":2,"path":"weights"}}]}],
"accessors":[{"bufferView":0,"componentType":5121,"normalized":true,"count":4,"type":"VEC3"},
{"bufferView":3,"componentType":5121,"count":4,"type":"SCALAR"},
{"bufferView":0,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"},
{"bufferView":0,"componentType":5121,"normalized":true,"count":4,"type":"VEC4"},
{"componentType":5121,"count":4,"type":"VEC4"},
{"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,
"componentType":5121},"values":{"bufferView":1,"byteOffset":8}}},
{"bufferView":0,"componentType":5121,"normalized":true,"count":4,"type":"VEC4"},
{"bufferView":1,"byteOffset":32,"componentType":5126,"count":2,"type":"MAT4"},
{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR"},
{"bufferView":1,"byteOffset":200,"componentType":5126,"count":6,"type":"VEC4"}],
"bufferViews":[{"buffer":0,"byteLength":128,"byteStride":16},{"buffer":0,"byteLength":512},
{"buffer":1,"byteLength":8},{"buffer":2,"byteLength":4}],
"buffers":[{"byteLength":4096,"uri":"a.bin"},{"byteLength":8,"uri":"data:;base64,AAAAAAAAgD8="},
{"byteLength":4,"uri":"data:;base64,AAECAw=="}]})";

constexpr const char* kObj =
    "mtllib a.mtl\no thing\ng one two\nv 84616.5 447423.25 1e1\nv 84617 447423 2\nv 84617 447424 "
    "-3\n"
    "v 84616 447425 .5\nv 1 2 3\nvt 0 0\nvt 1 .5\nvn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1 4/2/1\n"
    "usemtl b lue\nf -1 -2 \\\n-3\nf 1//1 2//1 3//1 4//1 5//1\nl 1 2\np 1\ns off\n"
    "\x01newmtl red\nKd 1 0 0\nd 0.4\nmap_Kd -s 2 -o 1 1 -clamp on b.png\nmap_d c.png\n"
    "newmtl b lue\nKd 0 0 1\nTr 0.2\nNs 12\nKs 1 1 1\nillum 2\n";

}  // namespace

int main(int argument_count, char** arguments) {
    if (argument_count != 2) {
        std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
        return 2;
    }
    const fs::path folder = arguments[1];
    for (const char* target : {"gltf", "obj", "image"})
        fs::create_directories(folder / target);
    gnomon::write_glb(folder / "gltf" / "cube.glb", gnomon::make_builtin_scene("cube"));
    gnomon::write_file(folder / "gltf" / "all.gltf", kGltf);
    gnomon::write_file(folder / "obj" / "all", kObj);
    const std::vector<std::uint8_t> png = gnomon::image::encode_png(gradient(16));
    gnomon::write_file(folder / "image" / "a.png",
                       {reinterpret_cast<const char*>(png.data()), png.size()});
    gnomon::write_file(folder / "image" / "a.jpg", jpeg(24, false));
    gnomon::write_file(folder / "image" / "b.jpg", jpeg(24, true));
    return 0;
}
