#include "candela/plan.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.h"
#include "candela/work_queue.h"

namespace candela {
namespace {

namespace fs = std::filesystem;

/// Every picture once as a whole, or once in each of its parts.
void expect_cover(const std::vector<WorkPiece>& pieces, std::size_t pictures, int parts) {
  std::multiset<std::pair<std::size_t, int>> seen;
  for (const WorkPiece& piece : pieces) {
    for (std::size_t i = piece.pictures.first; i <= piece.pictures.last; ++i)
      seen.insert({i, piece.part ? piece.part->index : 1});
  }
  EXPECT_EQ(seen.size(), pictures * static_cast<std::size_t>(parts));
  for (std::size_t i = 1; i <= pictures; ++i) {
    for (int part = 1; part <= parts; ++part) EXPECT_EQ(seen.count({i, part}), 1u) << i << " " << part;
  }
}

TEST(unit_candela_plan, short_pictures_stay_together) {
  for (const std::size_t pictures : {1u, 7u, 48u, 1000u}) {
    const auto pieces = divide_work(pictures, 64, {.start_s = 10, .picture_s = 25}, 300);
    expect_cover(pieces, pictures, 1);
    EXPECT_EQ(pieces.size(), (pictures + 10) / 11);
    for (const WorkPiece& piece : pieces) {
      EXPECT_FALSE(piece.part);
      EXPECT_LE(piece.pictures.count(), 11u);
      EXPECT_GE(piece.pictures.count() + 1, pictures / pieces.size());
    }
  }
}

TEST(unit_candela_plan, long_pictures_are_parted) {
  const auto pieces = divide_work(3, 64, {.start_s = 0, .picture_s = 1000}, 300);
  expect_cover(pieces, 3, 4);
  EXPECT_EQ(pieces[0].part->count, 4);
  expect_cover(divide_work(3, 2, {.start_s = 0, .picture_s = 1000}, 300), 3, 2);  // no more parts than blocks
  expect_cover(divide_work(3, 1, {.start_s = 0, .picture_s = 1000}, 300), 3, 1);
}

TEST(unit_candela_plan, a_piece_works_as_long_as_it_starts) {
  EXPECT_EQ(divide_work(100, 64, {.start_s = 600, .picture_s = 60}, 300).size(), 10u);
  expect_cover(divide_work(1, 64, {.start_s = 600, .picture_s = 6000}, 300), 1, 10);
}

TEST(unit_candela_plan, only_pictures_with_their_number_of_samples_have_parts) {
  Shot shot;
  shot.traced.samples = 100;
  EXPECT_EQ(most_parts(shot), 7);
  shot.shutter_s = 0.1;
  EXPECT_EQ(most_parts(shot), 1);
  shot.shutter_s = 0.0;
  shot.traced.noise = 0.1f;
  EXPECT_EQ(most_parts(shot), 1);
  shot.traced.noise.reset();
  shot.engine = Engine::raster;
  EXPECT_EQ(most_parts(shot), 1);
}

TEST(unit_candela_plan, a_look_tells_the_time_of_all_samples) {
  Shot shot;
  shot.scene = "demo:spheres";
  shot.size = ivec2(32, 24);
  shot.environment = "furnace";
  shot.traced.samples = 16;
  const double few = measure_work(shot).picture_s;
  EXPECT_GT(few, 0.0);
  shot.traced.samples = 16 << 10;
  EXPECT_GT(measure_work(shot).picture_s, 10 * few);
  shot.traced.time_limit_s = 100.0;
  EXPECT_GE(measure_work(shot).picture_s, 100.0);
}

TEST(unit_candela_plan, ranges_of_pictures) {
  EXPECT_EQ(parse_pictures("9-16").first, 9u);
  EXPECT_EQ(parse_pictures("9-16").last, 16u);
  EXPECT_EQ(parse_pictures("9").count(), 1u);
  for (const char* text : {"", "0", "0-3", "3-2", "3-", "-3", "a", "1-2-3", "1 - 2", "99999999999999999999999"})
    EXPECT_THROW(parse_pictures(text), Error) << text;
}

class unit_candela_work_queue : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("candela-queue-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("jobs.txt", "one\n# a remark\n\n  two\nthree");
    write("jobs-merge.txt", "four\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  WorkQueue queue(const std::string& worker, double lease_s = 60.0) {
    return {{folder_ / "jobs.txt", folder_ / "jobs-merge.txt"}, worker, lease_s};
  }
  fs::path folder_;
};

TEST_F(unit_candela_work_queue, each_line_has_one_worker_and_stages_wait) {
  WorkQueue a = queue("a"), b = queue("b");
  EXPECT_EQ(a.claim()->command, "one");
  EXPECT_EQ(b.claim()->command, "  two");
  a.complete();
  EXPECT_EQ(a.claim()->command, "three");
  b.complete();
  EXPECT_FALSE(b.claim());  // a merge before all parts are there
  EXPECT_FALSE(b.is_finished());
  a.complete();
  const auto last = b.claim();
  EXPECT_EQ(last->command, "four");
  EXPECT_EQ(last->stage, 1u);
  EXPECT_FALSE(a.claim());
  b.complete();
  EXPECT_TRUE(a.is_finished());
  EXPECT_EQ(a.counts().done, 4u);
}

TEST_F(unit_candela_work_queue, a_line_of_a_worker_that_is_gone_waits_again) {
  WorkQueue a = queue("a", 0.2), b = queue("b", 0.2);
  EXPECT_EQ(a.claim()->command, "one");
  EXPECT_EQ(b.claim()->command, "  two");
  b.complete();
  EXPECT_EQ(b.claim()->command, "three");
  b.complete();
  for (int i = 0; i < 8; ++i) {  // kept
    ::usleep(50'000);
    EXPECT_TRUE(a.renew());
    EXPECT_FALSE(b.claim());
  }
  ::usleep(300'000);
  const auto taken_over = b.claim();
  ASSERT_TRUE(taken_over);
  EXPECT_EQ(taken_over->command, "one");
  EXPECT_EQ(taken_over->attempt, 2);
  EXPECT_FALSE(a.renew());
  a.complete();  // whose work was not in vain, but does not count
  EXPECT_EQ(b.counts().taken, 1u);
  EXPECT_EQ(b.counts().done, 2u);
}

TEST_F(unit_candela_work_queue, a_line_is_tried_three_times_and_again_when_asked) {
  WorkQueue a = queue("a");
  for (int attempt = 1; attempt <= WorkQueue::kMostAttempts; ++attempt) {
    const auto line = a.claim();
    EXPECT_EQ(line->command, "one");
    EXPECT_EQ(line->attempt, attempt);
    EXPECT_EQ(a.fail(), attempt < WorkQueue::kMostAttempts);
  }
  EXPECT_EQ(a.claim()->command, "  two");
  a.give_back();
  EXPECT_EQ(a.claim()->attempt, 1);
  ASSERT_EQ(a.failed().size(), 1u);
  EXPECT_EQ(a.failed()[0].command, "one");
  a.retry_failed();
  EXPECT_TRUE(a.failed().empty());
  EXPECT_EQ(a.counts().waiting, 3u);
}

TEST_F(unit_candela_work_queue, other_lines_are_refused) {
  { queue("a"); }
  write("jobs-merge.txt", "five\n");
  EXPECT_THROW(queue("a"), Error);
  write("jobs-merge.txt", "four\n");
  EXPECT_EQ(queue("b").counts().waiting, 4u);
  EXPECT_THROW(WorkQueue({folder_ / "absent.txt"}, "a", 60.0), Error);
}

}  // namespace
}  // namespace candela
