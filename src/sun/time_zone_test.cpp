#include <gnomon/error.h>
#include <gnomon/sun.h>

#include <gtest/gtest.h>

#include <string>

namespace gnomon {
namespace {

using namespace std::chrono;

minutes berlin(year_month_day date) {
    return zone_utc_offset("--utc-offset", "Europe/Berlin", date);
}

TEST(ZoneUtcOffset, KnowsSummerTime) {
    EXPECT_EQ(berlin(2026y / January / 15), 60min);
    EXPECT_EQ(berlin(2026y / June / 21), 120min);
    EXPECT_EQ(zone_utc_offset("", "America/New_York", 2026y / July / 4), -240min);
    EXPECT_EQ(zone_utc_offset("", "Australia/Adelaide", 2026y / January / 1), 630min);
    EXPECT_EQ(zone_utc_offset("", "Asia/Kathmandu", 2026y / June / 21), 345min);
    EXPECT_EQ(zone_utc_offset("", "UTC", 2026y / June / 21), 0min);
}

// Clocks are put forward on 29 March 2026 at 2:00 and back on 25 October at 3:00: by noon they are.
TEST(ZoneUtcOffset, OfADayOnWhichClocksChangeIsThatOfItsNoon) {
    EXPECT_EQ(berlin(2026y / March / 28), 60min);
    EXPECT_EQ(berlin(2026y / March / 29), 120min);
    EXPECT_EQ(berlin(2026y / October / 24), 120min);
    EXPECT_EQ(berlin(2026y / October / 25), 60min);
}

TEST(ZoneUtcOffset, KnowsOtherYears) {
    EXPECT_EQ(berlin(1975y / July / 1), 60min);  // no summer time then
    // After 2037, until when files list changes, by the rule at their end.
    EXPECT_EQ(berlin(2099y / July / 1), 120min);
    EXPECT_EQ(berlin(2099y / January / 1), 60min);
    EXPECT_EQ(berlin(2041y / March / 30), 60min);
    EXPECT_EQ(berlin(2041y / March / 31), 120min);
    EXPECT_EQ(zone_utc_offset("", "Australia/Sydney", 2080y / January / 1), 660min);
    EXPECT_EQ(zone_utc_offset("", "Asia/Tokyo", 2080y / July / 1), 540min);
    // 19 min 32 s.
    EXPECT_EQ(zone_utc_offset("", "Europe/Brussels", 1900y / January / 1), 0min);
    EXPECT_THROW(berlin(2100y / July / 1), Error);
}

std::string error_of(const char* zone) {
    try {
        zone_utc_offset("--utc-offset", zone, 2026y / June / 21);
        return "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
}

TEST(ZoneUtcOffset, SuggestsTheNearestName) {
    for (const char* const near :
         {"Europe/Berln", "europe/berlin", "Berlin", "berlin", "EUROPE/BERLIN", "Europe/berlin"}) {
        EXPECT_NE(error_of(near).find("is no time zone, did you mean \"Europe/Berlin\"?"),
                  std::string::npos)
            << error_of(near);
    }
    EXPECT_NE(error_of("new york").find("\"America/New_York\""), std::string::npos);
    const std::string nowhere = error_of("Xyzzyplugh");
    EXPECT_EQ(nowhere.find("did you mean"), std::string::npos) << nowhere;
    EXPECT_NE(nowhere.find("--utc-offset: \"Xyzzyplugh\" is no time zone; give a name such as"),
              std::string::npos)
        << nowhere;
    EXPECT_EQ(nowhere.find('\n'), std::string::npos);
}

TEST(ClockUtcOffset, IsAnOffsetOrAZones) {
    const auto date = 2026y / June / 21;
    EXPECT_EQ(clock_utc_offset("", "+03:30", date), 210min);
    EXPECT_EQ(clock_utc_offset("", "Z", date), 0min);
    EXPECT_EQ(clock_utc_offset("", "Europe/Berlin", date), 120min);
    EXPECT_EQ(clock_utc_offset("", "Zulu", date), 0min);
    for (const char* const text : {"+25:00", "2", "", "-"})
        EXPECT_THROW(clock_utc_offset("--utc-offset", text, date), Error) << text;
}

}  // namespace
}  // namespace gnomon
