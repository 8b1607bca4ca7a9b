#!/usr/bin/env python3
"""Starts a technique: techniques/<name>/ with its page, code, shader and test, and its line in
techniques/CMakeLists.txt. What it makes builds and passes the contract tests; it lights whatever faces the
light, until you write the rest. See docs/adding_a_technique.md.

    tools/new_technique.py NAME
"""

import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

CMAKE = """\
gnomon_module(@name@ DEPENDS technique)
gnomon_shaders(gnomon_@name@)
"""

CODE = """\
// @title@: TODO what it does, in a sentence. TODO authors, "Title", where, year. TODO how this
// differs from that publication, and why.

#include "@name@.comp.spv.h"
#include "technique/param_table.h"
#include "technique/technique_base.h"
#include "visibility/light_shape.h"
#include "visibility/lookup_pipeline.h"

namespace gnomon {

const TechniqueInfo& @name@_info();

namespace {

constexpr unsigned kGroupSize = 8;  // as in @name@.comp.glsl

// One member a parameter, and one row of the table, for instance
//     double radius_m = 0.1;
//     number("radius", &Options::radius_m, 0.0, 10.0, "m", "how far the filter reaches")
struct Options {};

const ParamTable<Options>& param_table() {
    static const ParamTable<Options> table("@name@", {});
    return table;
}

class @Class@ final : public GpuTechnique {
public:
    @Class@(Context& context, const Options& options)
        : GpuTechnique(context, @name@_info()), options_(options) {
        const gpu::Device& device = context.impl().device();
        using enum gpu::BindingType;
        lookup_ = LookupPipeline(device, {.code = shaders::@name@_comp,
                                         .layout = {{texture, storage_image, storage_image},
                                                    sizeof(shared::ReceiverPush)}});
        nearest_ = gpu::Sampler(device, {});
    }

private:
    void record(gpu::Commands& commands, const RecordInput& input,
                gpu::Image& visibility) override {
        const gpu::Pass pass(commands, "lookup");
        commands.use(visibility, gpu::Use::storage_write);
        const gpu::Pipeline& lookup = lookup_.of(input.frame.light);
        commands.bind(lookup, {gpu::Texture{input.receivers.depth.view(), &nearest_},
                                gpu::StorageImage{input.receivers.normals.view()},
                                gpu::StorageImage{visibility.view()}});
        commands.push(lookup, receiver_push(input.receivers, input.frame.light));
        commands.dispatch(input.frame.size, kGroupSize);
    }

    std::uint64_t memory_bytes() const override { return 0; }

    [[maybe_unused]] Options options_;
    LookupPipeline lookup_;
    gpu::Sampler nearest_;
};

}  // namespace

const TechniqueInfo& @name@_info() {
    static const TechniqueInfo info{
        .name = "@name@",
        .title = "@title@",
        .source = "",  // TODO keys of docs/references.bib
        .lights = LightKinds::directional,
        .penumbra = Penumbra::none,
        .params = []() -> const std::vector<ParamInfo>& { return param_table().infos(); },
        .make = [](Context& context, const Params& params) -> std::unique_ptr<Technique> {
            return std::make_unique<@Class@>(context, param_table().options(params));
        }};
    return info;
}

}  // namespace gnomon
"""

SHADER = """\
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "visibility/receiver.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform sampler2D depths;
layout(set = 0, binding = 1, r32ui) uniform readonly uimage2D normals;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D visibility;
layout(push_constant, scalar) uniform Push { ReceiverPush push; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, push.size))) return;
    float depth = texelFetch(depths, ivec2(pixel), 0).x;
    float lit = 1.0;  // where there is no receiver
    if (depth > 0.0) {
        vec3 p_es = receiver_position(push.es_from_clip, pixel, push.size, depth);
        vec3 normal_ws = unpack_unit_vector(imageLoad(normals, ivec2(pixel)).x);
        lit = faces_light(push.light, p_es, normal_ws) ? 1.0 : 0.0;  // TODO what casts on p_ws?
    }
    imageStore(visibility, ivec2(pixel), vec4(lit));
}
"""

TEST = """\
#include <gnomon/technique.h>

#include <gtest/gtest.h>

namespace gnomon {
namespace {

// A square of 20 m on the ground, seen from above.
Scene bare_ground() {
    SceneData data;
    data.materials.emplace_back();
    data.meshes.push_back({.name = "ground",
                           .positions = {{-10, 0, -10}, {-10, 0, 10}, {10, 0, 10}, {10, 0, -10}},
                           .triangles = {{0, 1, 2}, {0, 2, 3}}});
    data.instances.push_back({.mesh = 0, .name = "ground"});
    return Scene(std::move(data));
}

TEST(@Class@, BareGroundIsFullyLit) {
    Context context({.validation = true});
    const Frame frame{.scene = bare_ground(),
                      .camera = look_at({0.0f, 10.0f, 10.0f}, {0.0f, 0.0f, 0.0f}),
                      .light = sun(radians(45.0f), radians(120.0f), 0.0f),
                      .size = {64, 36}};
    const Visibility visibility = make_technique(context, "@name@")->render(frame);
    for (const float lit : visibility.image().pixels())
        ASSERT_EQ(lit, 1.0f);  // exactly: nothing is there to cast
    EXPECT_TRUE(context.validation_messages().empty());
}

}  // namespace
}  // namespace gnomon
"""

PAGE = """\
# @title@

TODO What it does, for whom, in two or three sentences.

| | |
|---|---|
| lights | directional |
| penumbra | none |
| alpha masks | honoured |

## How it works

TODO The algorithm, with the formulas that matter.

## Sources

TODO One line each, those of TechniqueInfo::source first: - `key`: authors, *title*, where, year.

TODO Departures, with the reasons.

## Parameters

<!-- parameters -->
None.
<!-- /parameters -->

## What it does well, and its limits

TODO What it gets wrong, and how that looks; what it costs.
"""


def fill(template, name):
    words = name.split("_")
    return (template.replace("@name@", name)
            .replace("@Class@", "".join(word.capitalize() for word in words))
            .replace("@title@", " ".join(words).capitalize()))


def make(root, name):
    """Makes the technique; raises ValueError, and makes nothing, when `name` will not do."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise ValueError(f'"{name}" is no name for a technique: use snake_case, as in shadow_map')
    folder = root / "techniques" / name
    if folder.exists() or (root / "src" / name).exists():
        raise ValueError(f"there is a {name} already")
    files = {
        "CMakeLists.txt": CMAKE,
        "README.md": PAGE,
        f"{name}.cpp": CODE,
        f"{name}.comp.glsl": SHADER,
        f"{name}_test.cpp": TEST,
    }
    folder.mkdir()
    for file, template in files.items():
        (folder / file).write_text(fill(template, name), encoding="utf-8")
    if shutil.which("clang-format"):  # where lines break depends on the length of the name
        subprocess.run(["clang-format", "-i", *folder.glob("*.cpp")], check=True)

    listing = root / "techniques" / "CMakeLists.txt"
    lines = listing.read_text(encoding="utf-8").splitlines()
    first = next((i for i, line in enumerate(lines) if line.startswith("gnomon_technique(")), len(lines))
    lines[first:] = sorted([*lines[first:], f"gnomon_technique({name})"])
    listing.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        folder = make(ROOT, sys.argv[1])
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"made {folder.relative_to(ROOT)} and its line in techniques/CMakeLists.txt\n"
          f"next: ./test -R {sys.argv[1]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
