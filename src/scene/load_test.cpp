#include "scene/load_draft.h"
#include "scene/load_files.h"
#include "scene/load_test_scene.h"
#include "scene/load_texture.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace gnomon::scene {
namespace {

namespace fs = std::filesystem;

std::string error_of(const std::string& path_or_name) {
    try {
        load_scene(path_or_name);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return {};
}

TEST(LoadScene, BuiltInScenesAreLoadedByName) {
    EXPECT_GT(load_scene("cube").triangle_count(), 0u);
    EXPECT_NE(error_of("cubee").find("did you mean \"cube\"?"), std::string::npos);
}

TEST(LoadScene, WhatIsNoSceneFileIsNamed) {
    const TestFolder folder;
    const std::string text = folder.write("notes.txt", "hello");
    EXPECT_NE(error_of((folder.path() / "none.gltf").string()).find("none.gltf: no such file"),
              std::string::npos);
    EXPECT_NE(error_of(folder.path().string()).find("is a folder"), std::string::npos);
    EXPECT_NE(error_of(text).find("notes.txt"), std::string::npos);
    fs::create_directory(folder.path() / "folder.obj");
    EXPECT_NE(error_of((folder.path() / "folder.obj").string()).find("is a folder"),
              std::string::npos);
    EXPECT_NE(error_of("").find("no such file"), std::string::npos);
}

TEST(LoadScene, CanBeCancelled) {
    struct Cancelled : Progress {
        bool cancelled() const override { return true; }
    } progress;
    TestGltf gltf;
    gltf.add_triangle();
    const TestFolder folder;
    try {
        load_scene(gltf.write(folder), {}, progress);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

TEST(SceneFolder, ReadsNothingOutside) {
    const TestFolder outside;
    outside.write("canary", "secret");
    outside.write("inside/file", "fine");
    outside.write("inside/deep/file", "fine");
    fs::create_symlink("../canary", outside.path() / "inside" / "link");
    fs::create_symlink("..", outside.path() / "inside" / "folder");
    fs::create_symlink("deep/file", outside.path() / "inside" / "good_link");
    const SceneFolder files(outside.path() / "inside" / "scene.gltf");
    for (const std::string name : {"file", "deep/file", "deep/../file", "./file", "good_link"}) {
        EXPECT_TRUE(files.exists(name)) << name;
        EXPECT_EQ(files.read(name).size(), 4u) << name;
    }
    const std::string absolute = (outside.path() / "canary").string();
    for (const std::string& name :
         {std::string("../canary"), std::string("deep/../../canary"), std::string("link"),
          std::string("folder/canary"), absolute, "file://" + absolute, std::string("C:/canary"),
          std::string("http://a/b"), std::string(""), std::string("."), std::string(".."),
          std::string("file\0", 5), std::string("/"), std::string("deep")}) {
        EXPECT_FALSE(files.exists(name)) << name;
        EXPECT_THROW(files.read(name), Error) << name;
    }
}

TEST(SceneFolder, IsTheFolderOfALinkToTheScene) {
    const TestFolder folder;
    folder.write("real/scene.gltf", "");
    folder.write("here/file", "fine");
    fs::create_symlink("../real/scene.gltf", folder.path() / "here" / "scene.gltf");
    EXPECT_TRUE(SceneFolder(folder.path() / "here" / "scene.gltf").exists("file"));
}

TEST(Uri, PercentCodesAreDecodedOnceAndOthersKept) {
    EXPECT_EQ(percent_decoded("a%20b+c%2520%zz%4"), "a b+c%20%zz%4");
    EXPECT_EQ(percent_decoded("%41"), "A");
}

TEST(Uri, DataIsBase64) {
    const std::vector<std::uint8_t> bytes = decode_data_uri("data:application/x;base64,AQID/w==");
    EXPECT_EQ(bytes, (std::vector<std::uint8_t>{1, 2, 3, 255}));
    EXPECT_TRUE(decode_data_uri("data:;base64,").empty());
    for (const char* uri : {"data:text/plain,abc", "data:;base64", "data:;base64,A*==", "data:"}) {
        EXPECT_THROW(decode_data_uri(uri), Error) << uri;
    }
}

TEST(Warnings, EqualFaultsAreOneLine) {
    Warnings warnings;
    for (const char* name : {"a", "b", "c", "d", "e"})
        warnings.add("a thing is odd", name);
    warnings.add("numbers are odd", "mesh", 7);
    warnings.add("it is late");
    warnings.add("it is late");
    warnings.add("a line", "with\nbreaks\x1b");
    EXPECT_EQ(warnings.lines(),
              (std::vector<std::string>{"a thing is odd: a, b, c and 2 more",
                                        "numbers are odd: mesh (7 in all)", "it is late (2 in all)",
                                        "a line: with breaks "}));
}

TEST(Recentring, MovesOnlyWhatFloatCannotHold) {
    const auto offset = [](DVec3 min, DVec3 max) { return recentring_offset_m({min, max}); };
    EXPECT_EQ(recentring_offset_m({}), DVec3(0.0));
    EXPECT_EQ(offset({0, 0, 0}, {10, 3, 10}), DVec3(0.0)) << "a room";
    EXPECT_EQ(offset({100, 0, 0}, {110, 3, 10}), DVec3(0.0)) << "a room across the road";
    EXPECT_EQ(offset({0, 0, 0}, {100000, 1000, 100000}), DVec3(0.0))
        << "a country: moving would gain one bit";
    EXPECT_EQ(offset({84616, 447423, -1}, {85140, 447750, 14}), DVec3(84878, 447587, 0))
        << "a city, whose heights are fine";
    EXPECT_EQ(offset({0.25, 0, 0}, {0.25001, 1e-5, 1e-5}), DVec3(0.0))
        << "whole metres cannot help a grain of dust";
}

TEST(Texture, MasksOfAnotherSizeAreScaled) {
    const image::Rgba8 color{{1, 1}, {10, 20, 30, 255}};
    const image::Rgba8 mask{{2, 1}, {0, 0, 0, 7, 0, 0, 0, 255}};
    const image::Rgba8 result = with_mask(color, mask);
    EXPECT_EQ(result.rgba, (std::vector<std::uint8_t>{10, 20, 30, 7, 10, 20, 30, 255}))
        << "an alpha channel that is used counts more than the colours";
}

}  // namespace
}  // namespace gnomon::scene
