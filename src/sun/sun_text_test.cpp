#include <gnomon/error.h>
#include <gnomon/sun.h>

#include <gtest/gtest.h>

#include <string>

namespace gnomon {
namespace {

using namespace std::chrono;

template <typename Parse>
std::string error_of(Parse parse, const char* text) {
    try {
        parse("--value", text);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        const std::string message = error.what();
        EXPECT_EQ(message.rfind("--value: ", 0), 0u) << message;
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return message;
    }
    ADD_FAILURE() << "no error for " << text;
    return {};
}

CivilTime parse_zoned(std::string_view flag, std::string_view text) {
    return parse_time(flag, text);
}

TEST(ParsePlace, TakesDegreesAndMetres) {
    const Place munich = parse_place("--place", "48.137,11.575");
    EXPECT_EQ(munich.latitude_deg, 48.137);
    EXPECT_EQ(munich.longitude_deg, 11.575);
    EXPECT_EQ(munich.height_m, 0.0);
    EXPECT_EQ(parse_place("--place", "-90,-180,-500").height_m, -500.0);
}

TEST(ParsePlace, NamesTheFault) {
    for (const char* const text : {"48.137", "1,2,3,4", "48,", "48,x", "48.1 N,11", ",", "1;2"}) {
        EXPECT_NE(error_of(parse_place, text).find("48.137,11.575,520"), std::string::npos);
    }
    try {
        parse_place("--place", "91.5,0");
        FAIL();
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "--place: latitude 91.5 is out of range; -90 to 90 is allowed");
    }
    EXPECT_THROW(parse_place("--place", "0,180.5"), Error);
    EXPECT_THROW(parse_place("--place", "0,0,20000"), Error);
    EXPECT_THROW(parse_place("--place", "nan,0"), Error);
}

TEST(ParseDate, TakesDatesThatExist) {
    EXPECT_EQ(parse_date("--date", "2026-06-21"), year(2026) / 6 / 21);
    EXPECT_EQ(parse_date("--date", "2024-02-29"), year(2024) / 2 / 29);
}

TEST(ParseDate, NamesTheFault) {
    EXPECT_NE(error_of(parse_date, "2026-02-30").find("2026-02 has the days 01 to 28"),
              std::string::npos);
    EXPECT_NE(error_of(parse_date, "2026-13-01").find("months are 01 to 12"), std::string::npos);
    EXPECT_NE(error_of(parse_date, "1899-12-31").find("1900 to 2099"), std::string::npos);
    for (const char* const text : {"2026-6-21", "21.06.2026", "2026-06-21x", "", "2026/06/21"}) {
        EXPECT_NE(error_of(parse_date, text).find("such as 2026-06-21"), std::string::npos);
    }
}

TEST(ParseUtcOffset, TakesTheCustomaryForms) {
    EXPECT_EQ(parse_utc_offset("--utc-offset", "Z"), minutes(0));
    EXPECT_EQ(parse_utc_offset("--utc-offset", "+02:00"), minutes(120));
    EXPECT_EQ(parse_utc_offset("--utc-offset", "-0330"), minutes(-210));
    EXPECT_EQ(parse_utc_offset("--utc-offset", "+2"), minutes(120));
    EXPECT_EQ(parse_utc_offset("--utc-offset", "+18:00"), minutes(1080));
}

TEST(ParseUtcOffset, NamesTheFault) {
    for (const char* const text :
         {"2", "+18:01", "+02:60", "+02:", "+", "Europe/Berlin", "+02:0"}) {
        EXPECT_NE(error_of(parse_utc_offset, text).find("-18:00 to +18:00"), std::string::npos);
    }
}

TEST(ParseTime, TakesDateClockAndOffset) {
    const CivilTime time = parse_time("--time", "2003-10-17T12:30:30-07:00");
    EXPECT_EQ(time.utc, sys_days(year(2003) / 10 / 17) + hours(19) + minutes(30) + seconds(30));
    EXPECT_EQ(time.utc_offset, hours(-7));
    EXPECT_EQ(to_string(time), "2003-10-17T12:30:30-07:00");
    EXPECT_EQ(parse_time("--time", "2003-10-17T12:30:30.25Z").utc,
              sys_days(year(2003) / 10 / 17) + hours(12) + minutes(30) + milliseconds(30250));
    EXPECT_EQ(to_string(parse_time("--time", "2026-06-21 12:30", hours(2))),
              "2026-06-21T12:30:00+02:00");
    EXPECT_EQ(to_string(parse_time("--time", "2026-06-21T23:59:59.6Z")),
              "2026-06-22T00:00:00+00:00");
}

TEST(ParseTime, NamesTheFault) {
    EXPECT_NE(
        error_of(parse_zoned, "2026-06-21T12:00").find("add one, such as 2026-06-21T12:00+02"),
        std::string::npos);
    EXPECT_NE(error_of(parse_zoned, "2026-02-30T12:00Z").find("does not exist"), std::string::npos);
    for (const char* const text :
         {"2026-06-21", "2026-06-21T24:00Z", "2026-06-21T12:60Z", "2026-06-21T12:00:60Z",
          "2026-06-21T12Z", "2026-06-21T12:00:00.Z"}) {
        EXPECT_NE(error_of(parse_zoned, text).find("00:00:00 to 23:59:59"), std::string::npos);
    }
    EXPECT_THROW(parse_time("--time", "2026-06-21T12:00CEST"), Error);
}

TEST(NearestUtcOffset, IsTheSunsHour) {
    EXPECT_EQ(nearest_utc_offset({48.137, 11.575, 0.0}), hours(1));
    EXPECT_EQ(nearest_utc_offset({0.0, -105.18, 0.0}), hours(-7));
    EXPECT_EQ(nearest_utc_offset({0.0, 180.0, 0.0}), hours(12));
    EXPECT_EQ(utc_offset_text(minutes(-210)), "-03:30");
}

}  // namespace
}  // namespace gnomon
