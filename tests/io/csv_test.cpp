#include "io/csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "phyxel/error.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::read_bytes;
using test::TemporaryDirectory;

TEST(Csv, reads_back_as_the_same_numbers) {
    const TemporaryDirectory folder;
    const std::vector<std::string> columns = {"time", "tip.x", "tip.y"};
    const std::vector<double> values = {1.0 / 3, -1e-310, std::numeric_limits<double>::max()};
    CsvWriter csv(folder / "probes.csv", columns);
    csv.add_row(values);
    csv.add_row(std::vector<double>{0, -0.0, 60});
    EXPECT_FALSE(std::filesystem::exists(folder / "probes.csv"));
    csv.finish();

    std::istringstream text(read_bytes(folder / "probes.csv"));
    std::string line, field;
    std::getline(text, line);
    EXPECT_EQ(line, "time,tip.x,tip.y");
    std::getline(text, line);
    std::istringstream row(line);
    for (const double value : values) {
        ASSERT_TRUE(std::getline(row, field, ','));
        EXPECT_EQ(std::strtod(field.c_str(), nullptr), value) << field;
    }
    EXPECT_FALSE(std::getline(row, field, ','));
    std::getline(text, line);
    EXPECT_EQ(line, "0,-0,60");
    EXPECT_FALSE(std::getline(text, line));
}

TEST(Csv, quotes_names_that_would_break_the_table) {
    const TemporaryDirectory folder;
    const std::vector<std::string> columns = {"a,b.x", "say \"x\""};
    CsvWriter csv(folder / "a.csv", columns);
    csv.finish();
    EXPECT_EQ(read_bytes(folder / "a.csv"), "\"a,b.x\",\"say \"\"x\"\"\"\n");
}

TEST(Csv, never_holds_a_value_that_is_not_finite) {
    const TemporaryDirectory folder;
    {
        CsvWriter csv(folder / "a.csv", std::vector<std::string>{"x"});
        EXPECT_THROW(csv.add_row(std::vector<double>{std::nan("")}), Error);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace phyxel
