#include <chrono>
#include <sstream>

#include "shell.h"
#include "support/measured.h"

namespace phyxel {
namespace {

using StudyCommand = Shell;

/// Names of the studies that this version has.
std::vector<std::string> names_of_studies(const std::string& list) {
    std::vector<std::string> names;
    std::istringstream lines(list);
    std::string line;
    std::getline(lines, line);  // the title
    while (std::getline(lines, line))
        if (line.find("not available yet") == line.npos) names.push_back(line.substr(2, line.find(' ', 2) - 2));
    return names;
}

std::string state_hash(const std::string& out) {
    const std::size_t at = out.find("state hash ");
    return at == out.npos ? "" : out.substr(at, 27);
}

TEST_F(StudyCommand, list_names_every_study) {
    const Outcome outcome = shell("phyxel study list");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(names_of_studies(outcome.out).size(), 12u) << outcome.out;
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(names().empty());
}

TEST_F(StudyCommand, unknown_and_missing_studies_are_refused_by_name) {
    const Outcome unknown = shell("phyxel study acuracy");
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.err.find("no study named 'acuracy'; did you mean 'accuracy'?"), std::string::npos) << unknown.err;
    EXPECT_TRUE(names().empty());
}

TEST_F(StudyCommand, a_study_leaves_a_table_and_its_script_and_a_picture_where_it_can) {
    const Outcome outcome = shell("phyxel study rotation --small -o out");
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    const std::string table = content(work() / "out/rotation.csv");
    EXPECT_EQ(table.substr(0, table.find('\n')), "rotation,stretch,turned [deg],work of a loop");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 13);
    EXPECT_EQ(content(work() / "out/plot.py"), content(PHYXEL_SOURCE_DIR "/studies/plot.py"));
    EXPECT_NE(std::filesystem::exists(work() / "out/rotation.png"),
              outcome.err.find("no picture: ") != std::string::npos);
}

TEST_F(StudyCommand, without_python_there_is_a_table_and_a_message) {
    const Outcome outcome = shell("PATH=/nowhere phyxel study rotation --small -o out");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    EXPECT_NE(outcome.err.find("no picture: there is no python3 here"), std::string::npos) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(work() / "out/rotation.csv"));
}

TEST_F(StudyCommand, a_study_holds_its_claims_with_the_same_bits_for_1_and_3_threads) {
    const Outcome one = shell("PATH=/nowhere phyxel study support --small --threads 1 -o out");
    const Outcome three = shell("PATH=/nowhere phyxel study support --small --threads 3 -o out");
    EXPECT_EQ(one.code, 0) << one.out << one.err;
    EXPECT_EQ(three.code, 0) << three.out << three.err;
    EXPECT_NE(state_hash(one.out), "");
    EXPECT_EQ(state_hash(one.out), state_hash(three.out));
}

TEST_F(StudyCommand, LONG_every_study_holds_its_claims_at_small_size_with_the_same_bits_for_1_2_3_and_8_threads) {
    for (const std::string& study : names_of_studies(shell("phyxel study list").out)) {
        const auto run = [&](const std::string& threads) {
            const auto start = std::chrono::steady_clock::now();
            const Outcome outcome =
                shell("phyxel study " + study + " --small --threads " + threads + " -o out/" + study);
            measured(study + " on " + threads + " threads [s]",
                     std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
            EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
            return state_hash(outcome.out);
        };
        const std::string hash = run("1");
        EXPECT_NE(hash, "") << study;
        for (const char* threads : {"2", "3", "8"}) EXPECT_EQ(run(threads), hash) << study << ", " << threads;
    }
}

}  // namespace
}  // namespace phyxel
