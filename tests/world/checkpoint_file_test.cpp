#include "world/checkpoint_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/hash.h"
#include "phyxel/error.h"
#include "phyxel/vector.h"
#include "phyxel/version.h"
#include "support/file_bytes.h"
#include "support/temporary_directory.h"

namespace phyxel {
namespace {

using test::read_bytes;
using test::TemporaryDirectory;
using test::write_bytes;

const std::vector<Vec3> positions = {{1, 2, 3}, {0.1, -0.0, 1e-300}};

/// A small checkpoint: an array, a number, a text and an empty section.
CheckpointWriter small_checkpoint() {
    CheckpointWriter writer;
    writer.add_values("positions", std::span(positions));
    writer.add_value("step", std::uint64_t(42));
    writer.add("scene", "jelly");
    writer.add("nothing", std::span<const std::byte>());
    return writer;
}

/// What reading everything in these bytes is refused with; empty when nothing is wrong.
std::string refusal(const TemporaryDirectory& folder, const std::string& bytes) {
    write_bytes(folder / "damaged", bytes);
    try {
        CheckpointReader reader(folder / "damaged");
        reader.values<Vec3>("positions");
        reader.value<std::uint64_t>("step");
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

template <class Integer>
void replace(std::string& bytes, std::size_t offset, Integer value) {
    bytes.replace(offset, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
}

/// Gives altered bytes the checksum that belongs to them.
void sign(std::string& bytes) {
    const std::size_t content = bytes.size() - 8;
    replace(bytes, content, hash64(std::as_bytes(std::span(bytes).first(content))));
}

class CheckpointFile : public testing::Test {
protected:
    CheckpointFile() {
        small_checkpoint().write(folder_ / "whole");
        whole_ = read_bytes(folder_ / "whole");
    }

    TemporaryDirectory folder_;
    std::string whole_;
};

TEST_F(CheckpointFile, gives_back_what_was_added_bit_by_bit) {
    const CheckpointReader reader(folder_ / "whole");
    EXPECT_EQ(reader.library_version(), version);
    EXPECT_EQ(reader.values<Vec3>("positions"), positions);
    EXPECT_TRUE(std::signbit(reader.values<Vec3>("positions", 2)[1].y));
    EXPECT_EQ(reader.value<std::uint64_t>("step"), 42u);
    EXPECT_EQ(reader.text("scene"), "jelly");
    EXPECT_TRUE(reader.values<double>("nothing").empty());
    EXPECT_TRUE(reader.has("nothing"));
    EXPECT_FALSE(reader.has("velocities"));
    EXPECT_EQ(refusal(folder_, whole_), "");
}

TEST_F(CheckpointFile, is_the_same_bytes_for_the_same_content) {
    small_checkpoint().write(folder_ / "again");
    EXPECT_TRUE(read_bytes(folder_ / "again") == whole_);
}

TEST_F(CheckpointFile, with_any_byte_altered_is_refused) {
    for (std::size_t i = 0; i < whole_.size(); ++i)
        for (const int mask : {0x01, 0x80, 0xff}) {
            std::string damaged = whole_;
            damaged[i] = static_cast<char>(damaged[i] ^ mask);
            EXPECT_NE(refusal(folder_, damaged), "") << "byte " << i;
        }
}

TEST_F(CheckpointFile, cut_off_anywhere_is_refused) {
    for (std::size_t size = 0; size < whole_.size(); ++size)
        EXPECT_NE(refusal(folder_, whole_.substr(0, size)), "") << size << " bytes";
}

TEST_F(CheckpointFile, cut_off_and_announced_and_signed_so_is_refused) {
    for (std::size_t size = 32; size < whole_.size(); ++size) {
        std::string damaged = whole_.substr(0, size);
        replace(damaged, 16, std::uint64_t(size));
        sign(damaged);
        EXPECT_NE(refusal(folder_, damaged), "") << size << " bytes";
    }
}

TEST_F(CheckpointFile, with_a_huge_length_anywhere_is_refused_even_when_signed) {
    for (std::size_t i = 24; i + 16 <= whole_.size(); ++i) {
        for (const std::uint64_t length : {std::uint64_t(1) << 40, std::numeric_limits<std::uint64_t>::max()}) {
            std::string damaged = whole_;
            replace(damaged, i, length);
            sign(damaged);
            refusal(folder_, damaged);  // may be accepted where content was replaced; must not crash
        }
        std::string damaged = whole_;
        replace(damaged, i, std::uint32_t(0xfffffff0));
        sign(damaged);
        refusal(folder_, damaged);
    }
    const std::size_t length_of_positions = whole_.find("positions") + 9;
    std::string damaged = whole_;
    replace(damaged, length_of_positions, std::uint64_t(1) << 60);
    sign(damaged);
    EXPECT_NE(refusal(folder_, damaged).find("a length in it exceeds the file"), std::string::npos);
}

TEST_F(CheckpointFile, refusals_name_the_file_and_the_reason) {
    struct Row {
        std::string bytes, reason;
    };
    std::string newer = whole_, other_order = whole_, flipped = whole_, longer = whole_ + "x";
    replace(newer, 8, std::uint32_t(2));
    replace(other_order, 12, std::uint32_t(0x04030201));
    flipped[whole_.find("jelly")] = 'J';
    for (const Row& row : {Row{"", "is empty"}, Row{"PNG or something else, long enough", "not a checkpoint of phyxel"},
                           Row{"PHY", "ends within its header"}, Row{newer, "is of format 2, this version"},
                           Row{other_order, "other byte order"}, Row{flipped, "checksum does not match"},
                           Row{longer, "its header announces " + std::to_string(whole_.size())}}) {
        const std::string message = refusal(folder_, row.bytes);
        EXPECT_NE(message.find(row.reason), std::string::npos) << message;
        EXPECT_NE(message.find("cannot resume from " + (folder_ / "damaged").string()), std::string::npos) << message;
    }
}

TEST_F(CheckpointFile, that_is_missing_or_a_folder_is_refused) {
    EXPECT_THROW(CheckpointReader(folder_ / "missing"), Error);
    EXPECT_THROW(CheckpointReader{folder_.path()}, Error);
    EXPECT_THROW(CheckpointReader("/dev/zero"), Error);
}

TEST_F(CheckpointFile, is_left_as_it_was_when_the_disk_is_full) {
    std::filesystem::create_symlink("/dev/full", folder_ / ".whole.part");
    EXPECT_THROW(small_checkpoint().write(folder_ / "whole"), Error);
    EXPECT_TRUE(read_bytes(folder_ / "whole") == whole_);
    EXPECT_FALSE(std::filesystem::exists(folder_ / ".whole.part"));
}

TEST_F(CheckpointFile, sections_that_do_not_fit_are_refused) {
    const CheckpointReader reader(folder_ / "whole");
    EXPECT_THROW(reader.section("velocities"), Error);
    EXPECT_THROW(reader.values<double>("scene"), Error);
    EXPECT_THROW(reader.values<Vec3>("positions", 3), Error);
    EXPECT_THROW(reader.value<double>("nothing"), Error);
}

}  // namespace
}  // namespace phyxel
