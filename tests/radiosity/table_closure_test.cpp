#include "radiosity/table_closure.h"

#include <gtest/gtest.h>

#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

// The exchange of the inside of a sphere's zones, A_i A_j / A, with errors of up to `error`.
struct Disturbed {
  std::vector<double> area;
  ExchangeTable exchange;

  explicit Disturbed(double error) {
    test::Random random(3);
    double total = 0.0;
    for (int i = 0; i < 9; ++i) total += area.emplace_back(std::exp(random.in(-3.0, 3.0)));
    exchange.assign(9, std::vector<double>(9));
    for (std::size_t i = 0; i < 9; ++i)
      for (std::size_t j = i; j < 9; ++j)
        exchange[i][j] = exchange[j][i] = area[i] * area[j] / total * (1.0 + random.in(-error, error));
  }
  [[nodiscard]] double sum(std::size_t i) const {
    double sum = 0.0;
    for (const double x : exchange[i]) sum += x;
    return sum / area[i];
  }
};

TEST(TableClosure, MakesRowsAddUp) {
  Disturbed table(0.3);
  const Disturbed before = table;
  scale_rows_to_areas(table.exchange, table.area);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_GT(std::abs(before.sum(i) - 1.0), 1e-3);
    EXPECT_NEAR(table.sum(i), 1.0, 1e-12);
    for (std::size_t j = 0; j < 9; ++j) {
      EXPECT_EQ(table.exchange[i][j], table.exchange[j][i]);
      EXPECT_NEAR(table.exchange[i][j] / before.exchange[i][j], 1.0, 0.6);
    }
  }
}

TEST(TableClosure, LeavesEmptyRowsAlone) {
  ExchangeTable exchange{{0.0, 0.0, 0.0}, {0.0, 1.0, 1.1}, {0.0, 1.1, 0.0}};
  const std::vector<double> area{0.0, 2.0, 1.0};
  scale_rows_to_areas(exchange, area);
  EXPECT_EQ(exchange[0], std::vector<double>(3, 0.0));
  EXPECT_NEAR(exchange[1][1] + exchange[1][2], 2.0, 1e-12);
  EXPECT_NEAR(exchange[2][1], 1.0, 1e-12);
}

TEST(TableClosure, CapsOnlyWhatIsTooMuch) {
  Disturbed table(0.3);
  const Disturbed before = table;
  cap_rows_at_areas(table.exchange, table.area);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_LE(table.sum(i), 1.0 + 1e-14);
    EXPECT_LE(table.sum(i), before.sum(i));
    for (std::size_t j = 0; j < 9; ++j) EXPECT_EQ(table.exchange[i][j], table.exchange[j][i]);
  }
  ExchangeTable fine{{0.0, 0.5}, {0.5, 0.1}};
  const ExchangeTable copy = fine;
  cap_rows_at_areas(fine, std::vector<double>{1.0, 1.0});
  EXPECT_EQ(fine, copy);
}

}  // namespace
}  // namespace twopass
