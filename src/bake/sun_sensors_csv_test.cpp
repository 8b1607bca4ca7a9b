#include <gnomon/error.h>
#include <gnomon/sun_hours.h>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace gnomon {
namespace {

constexpr DVec3 kUp(0.0, 0.0, 1.0);

std::string message_of(std::string_view text) {
    try {
        parse_sun_sensors(text, "p.csv");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown for " << text;
    return {};
}

TEST(SunSensorsCsv, ArePlacesAndNormals) {
    const std::vector<SunSensor> sensors =
        parse_sun_sensors("1,2,3,0,0,2\r\n\n-1;+2.5;1e3\n 4\t 5\t6 \n7, 8, 9", "p.csv", kUp);
    ASSERT_EQ(sensors.size(), 4u);
    EXPECT_EQ(sensors[0].position_ws, DVec3(1, 2, 3));
    EXPECT_EQ(sensors[0].normal_ws, DVec3(0, 0, 2));
    EXPECT_EQ(sensors[1].position_ws, DVec3(-1, 2.5, 1000));
    EXPECT_EQ(sensors[1].normal_ws, kUp);
    EXPECT_EQ(sensors[2].position_ws, DVec3(4, 5, 6));
    EXPECT_EQ(sensors[3].position_ws, DVec3(7, 8, 9));
}

TEST(SunSensorsCsv, HaveTheColumnsThatAHeadingNames) {
    for (const char* const text :
         {"# c\n\nx,y,z,nx,ny,nz\n1,2,3,4,5,6\n# d\n", "z,y,x,nz,ny,nx\n3,2,1,6,5,4",
          "\xef\xbb\xbf"
          "NX; \"Y\" ;Z;X;NY;NZ\r\n4;2;3;1;5;6\r\n",
          "\"x\",\"y\",\"z\",\"nx\",\"ny\",\"nz\"\n\"1\",\"2\",\"3\",\"4\",5,6"}) {
        const std::vector<SunSensor> sensors = parse_sun_sensors(text, "p.csv", kUp);
        ASSERT_EQ(sensors.size(), 1u) << text;
        EXPECT_EQ(sensors[0].position_ws, DVec3(1, 2, 3)) << text;
        EXPECT_EQ(sensors[0].normal_ws, DVec3(4, 5, 6)) << text;
    }
    const std::vector<SunSensor> facing_up = parse_sun_sensors("z,x,y\n3,1,2\n", "p.csv", kUp);
    EXPECT_EQ(facing_up.at(0).position_ws, DVec3(1, 2, 3));
    EXPECT_EQ(facing_up.at(0).normal_ws, kUp);
}

TEST(SunSensorsCsv, FirstLinesOfNumbersArePoints) {
    const std::vector<SunSensor> sensors = parse_sun_sensors("\"0\",\"1\",\"0\"\n", "p.csv", kUp);
    ASSERT_EQ(sensors.size(), 1u);
    EXPECT_EQ(sensors[0].position_ws, DVec3(0, 1, 0));
}

TEST(SunSensorsCsv, ErrorsNameTheLineAndTheWayOut) {
    struct Case {
        const char *text, *fault;
    };
    for (const auto& [text, fault] : {
             Case{"1,2,3\n1,2\n", "p.csv, line 2: there are 2 values in: 1,2; a line is x,y,z"},
             {"x,y,z\n\n1,two,3\n", "p.csv, line 3: \"two\" is no finite number in: 1,two,3;"},
             {"1,2,nan\n", "line 1: \"nan\""},
             {"inf,0,0\n", "line 1: \"inf\""},
             {"east,north,height\n1,2,3\n", "line 1: \"east\""},
             {"1,2,3,0,0,0\n", "line 1: the normal"},
             {"1,2,3,\n", "line 1: \"\""},
             {"1,5;2,0;3,5\n",
              "line 1: \"1,5\" is no finite number in: 1,5;2,0;3,5; decimals take"},
             {"1,5\t2,0\t3,5\n", "decimals take a point"},
             {"1 2 3\n", "line 1: \"1 2 3\""},
             {"x,y,z,nx,ny,nz\n1,2,3\n",
              "line 2: there are 3 values in: 1,2,3; the heading names 6"},
             {"x,y,z,name\n1,2,3,a\n", "line 1: \"name\" is no column"},
             {"x,y,x\n1,2,3\n", "line 1: \"x\" is there twice"},
             {"x,y,nx\n1,2,3\n", "line 1: columns are missing"},
             {"x,y,z,nx\n1,2,3,4\n", "line 1: columns are missing"},
             {"1,2,3\nx,y,z\n", "line 2: \"x\""},
             {"\"1,2,3\n", "line 1: a quote is not closed"},
             {"\"1\"2,2,3\n", "line 1: there is more after a quote"},
             {"x,y,z\n", "p.csv: has no points"},
             {"# only\n", "p.csv: has no points"},
         }) {
        EXPECT_NE(message_of(text).find(fault), std::string::npos) << message_of(text);
    }
}

TEST(SunSensorsCsv, ErrorsTellTheBeginningOfALongLine) {
    const std::string told = message_of("1,2," + std::string(100, '\xc3') + std::string(4000, '9'));
    EXPECT_LT(told.size(), 400u);
}

TEST(SunPlanesCsv, AreACornerAndTwoEdges) {
    const std::vector<SunPlane> planes = parse_sun_planes(
        "# south, east\nvx,vy,vz,ux,uy,uz,x,y,z\n0,3,0,8,0,0,1,2,3\n0,3,0,0,0,-4,9,2,3\n", "p.csv");
    ASSERT_EQ(planes.size(), 2u);
    EXPECT_EQ(planes[0].corner_ws, DVec3(1, 2, 3));
    EXPECT_EQ(planes[0].u_ws, DVec3(8, 0, 0));
    EXPECT_EQ(planes[0].v_ws, DVec3(0, 3, 0));
    EXPECT_EQ(planes[1].u_ws, DVec3(0, 0, -4));
    EXPECT_EQ(parse_sun_planes("1;2;3;8;0;0;0;3;0", "p.csv").size(), 1u);
}

TEST(SunPlanesCsv, ErrorsNameTheLineAndTheWayOut) {
    struct Case {
        const char *text, *fault;
    };
    for (const auto& [text, fault] :
         {Case{"1,2,3\n", "p.csv, line 1: there are 3 values in: 1,2,3; a line is x,y,z,ux"},
          {"x,y,z\n1,2,3\n", "line 1: columns are missing in: x,y,z; columns are x, y, z, ux"},
          {"x,y,z,nx,ny,nz\n", "line 1: \"nx\" is no column"},
          {"0,0,0,1,0,0,1,1,0\n", "line 1: the edges make no rectangle"},
          {"0,0,0,1,0,0,0,0,0\n", "must have a length and be at right angles"},
          {"", "p.csv: has no planes"}}) {
        try {
            parse_sun_planes(text, "p.csv");
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
        }
    }
    std::string many;
    for (int i = 0; i < 1001; ++i)
        many += "0,0,0,1,0,0,0,1,0\n";
    EXPECT_THROW(parse_sun_planes(many, "p.csv"), Error);
}

}  // namespace
}  // namespace gnomon
