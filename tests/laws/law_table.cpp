// The laws that take long, over every row of the table: lobes alone, all combinations, mixtures and engines' models.

#include <gtest/gtest.h>

#include "laws/run_laws.h"

namespace candela::laws {
namespace {

TEST(law_table, white_furnace_is_within_what_is_promised) { expect_law(rows(1, is_any), energy); }

TEST(law_table, pdf_integrates_to_one) {
  expect_law(rows(1, is_any), pdf_integrates_to_one, pdf_integrates_to_one_tests());
}

TEST(law_table, sampling_follows_pdf) {
  expect_law(rows(1, is_any), sampling_follows_pdf, sampling_follows_pdf_tests());
}

TEST(law_table, mean_weight_is_albedo) {
  expect_law(rows(1, is_any), mean_weight_is_albedo, mean_weight_is_albedo_tests());
}

}  // namespace
}  // namespace candela::laws
