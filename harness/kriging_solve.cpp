#include "harness/kriging_solve.h"

#include <cmath>

#include "sampling/kriging/kriging_rules.h"
#include "sampling/vector_clones.h"

namespace abn::harness {
namespace {

using namespace kriging_rules;

constexpr int cells = quadrature;
constexpr std::size_t lanes = kriging_lanes;

/// Scalar products of the solved right sides: p pixel, o ones, x, y trend, z values.
struct Products {
  float pp[lanes] = {}, po[lanes] = {}, px[lanes] = {}, py[lanes] = {}, oo[lanes] = {}, ox[lanes] = {}, oy[lanes] = {};
  float xx[lanes] = {}, xy[lanes] = {}, yy[lanes] = {}, zz[lanes] = {}, zo[lanes] = {}, zx[lanes] = {}, zy[lanes] = {};
};

}  // namespace

void KrigingBatch::resize(std::size_t points) {
  count = points;
  for (std::vector<float>* array : {&x, &y, &diagonal, &value, &live, &weight}) array->assign(points * lanes, 0.0F);
  diagonal.assign(points * lanes, 1.0F);
  for (float& s : sill) s = 1;
  matrix.resize(points * (points + 1) / 2 * lanes);
  right.resize(5 * points * lanes);
}

ABN_VECTOR_CLONES void solve_kriging(KrigingBatch& batch) {
  const std::size_t n = batch.count;
  float* const matrix = batch.matrix.data();           // lower triangle, row by row; becomes its Cholesky factor
  float* const pixel = batch.right.data();             // covariances with the pixel, then solved forward
  float* const ones = batch.right.data() + n * lanes;  // likewise of 1
  float* const values = batch.right.data() + 2 * n * lanes;
  float* const trend_x = batch.right.data() + 3 * n * lanes;  // of x - 1/2
  float* const trend_y = batch.right.data() + 4 * n * lanes;
  float points[lanes] = {};
  Products of;
  for (std::size_t a = 0; a < n; ++a) {
    const float* const xa = batch.x.data() + a * lanes;
    const float* const ya = batch.y.data() + a * lanes;
    const float* const live = batch.live.data() + a * lanes;
    float* const row = matrix + a * (a + 1) / 2 * lanes;
    for (std::size_t b = 0; b < a; ++b) {
      const float* const xb = batch.x.data() + b * lanes;
      const float* const yb = batch.y.data() + b * lanes;
      const float* const other = matrix + b * (b + 1) / 2 * lanes;
      float s[lanes];
#pragma omp simd
      for (std::size_t l = 0; l < lanes; ++l) {
        const float dx = xa[l] - xb[l];
        const float dy = ya[l] - yb[l];
        s[l] = (batch.sill[l] - std::sqrt(dx * dx + dy * dy)) * live[l];
      }
      for (std::size_t k = 0; k < b; ++k) {
#pragma omp simd
        for (std::size_t l = 0; l < lanes; ++l) s[l] -= row[k * lanes + l] * other[k * lanes + l];
      }
#pragma omp simd
      for (std::size_t l = 0; l < lanes; ++l) row[b * lanes + l] = s[l] * other[b * lanes + l];
    }
    float distance[lanes] = {};
    for (int v = 0; v < cells; ++v) {
      for (int u = 0; u < cells; ++u) {
        const float cx = (static_cast<float>(u) + 0.5F) / cells;
        const float cy = (static_cast<float>(v) + 0.5F) / cells;
#pragma omp simd
        for (std::size_t l = 0; l < lanes; ++l) {
          const float dx = cx - xa[l];
          const float dy = cy - ya[l];
          distance[l] += std::sqrt(dx * dx + dy * dy + cell_spread);
        }
      }
    }
    float s[lanes], p[lanes], o[lanes], z[lanes], x[lanes], y[lanes];
#pragma omp simd
    for (std::size_t l = 0; l < lanes; ++l) {
      s[l] = batch.diagonal[a * lanes + l];
      p[l] = (batch.sill[l] - distance[l] / (cells * cells)) * live[l];
      o[l] = live[l];
      z[l] = batch.value[a * lanes + l];
      x[l] = (xa[l] - 0.5F) * live[l];
      y[l] = (ya[l] - 0.5F) * live[l];
      points[l] += live[l];
    }
    for (std::size_t k = 0; k < a; ++k) {
#pragma omp simd
      for (std::size_t l = 0; l < lanes; ++l) {
        const float factor = row[k * lanes + l];
        s[l] -= factor * factor;
        p[l] -= factor * pixel[k * lanes + l];
        o[l] -= factor * ones[k * lanes + l];
        z[l] -= factor * values[k * lanes + l];
        x[l] -= factor * trend_x[k * lanes + l];
        y[l] -= factor * trend_y[k * lanes + l];
      }
    }
#pragma omp simd
    for (std::size_t l = 0; l < lanes; ++l) {
      // The diagonal of the factor is kept inverted: it is only ever divided by.
      const float inverse = 1.0F / std::sqrt(s[l] > least_pivot ? s[l] : least_pivot);
      row[a * lanes + l] = inverse;
      p[l] *= inverse;
      o[l] *= inverse;
      z[l] *= inverse;
      x[l] *= inverse;
      y[l] *= inverse;
      pixel[a * lanes + l] = p[l];
      ones[a * lanes + l] = o[l];
      values[a * lanes + l] = z[l];
      trend_x[a * lanes + l] = x[l];
      trend_y[a * lanes + l] = y[l];
      of.pp[l] += p[l] * p[l];
      of.po[l] += p[l] * o[l];
      of.px[l] += p[l] * x[l];
      of.py[l] += p[l] * y[l];
      of.oo[l] += o[l] * o[l];
      of.ox[l] += o[l] * x[l];
      of.oy[l] += o[l] * y[l];
      of.xx[l] += x[l] * x[l];
      of.xy[l] += x[l] * y[l];
      of.yy[l] += y[l] * y[l];
      of.zz[l] += z[l] * z[l];
      of.zo[l] += z[l] * o[l];
      of.zx[l] += z[l] * x[l];
      of.zy[l] += z[l] * y[l];
    }
  }
  float multiplier[lanes];  // Lagrange's
#pragma omp simd
  for (std::size_t l = 0; l < lanes; ++l) {
    // A lane without any point divides by 1 and gives what nobody reads.
    const float norm = of.oo[l] > 0 ? of.oo[l] : 1.0F;
    const float rest = 1.0F - of.po[l];
    const float variance = batch.sill[l] - mean_square_distance - of.pp[l] + rest * rest / norm;
    batch.variance[l] = variance > least_variance ? variance : least_variance;
    multiplier[l] = rest / norm;
    // Generalised least squares of values on x and y, all freed of their means.
    const float xx = of.xx[l] - of.ox[l] * of.ox[l] / norm;
    const float xy = of.xy[l] - of.ox[l] * of.oy[l] / norm;
    const float yy = of.yy[l] - of.oy[l] * of.oy[l] / norm;
    const float zz = of.zz[l] - of.zo[l] * of.zo[l] / norm;
    const float zx = of.zx[l] - of.zo[l] * of.ox[l] / norm;
    const float zy = of.zy[l] - of.zo[l] * of.oy[l] / norm;
    const float determinant = xx * yy - xy * xy;
    const bool fitted = points[l] >= fewest_for_trend && determinant > collinear * xx * yy;
    const float scale = fitted ? 1.0F / (fitted ? determinant : 1.0F) : 0.0F;
    const float slope_x = (zx * yy - zy * xy) * scale;
    const float slope_y = (zy * xx - zx * xy) * scale;
    const float squares = zz - slope_x * zx - slope_y * zy;
    batch.squares[l] = squares > 0 ? squares : 0.0F;
    batch.degrees[l] = points[l] - (fitted ? 3.0F : 1.0F);
    // The estimate of x - 1/2 itself, whose integral is 0.
    batch.trend[l] = slope_x * (of.px[l] + multiplier[l] * of.ox[l]) + slope_y * (of.py[l] + multiplier[l] * of.oy[l]);
  }
  for (std::size_t a = 0; a < n; ++a) {
#pragma omp simd
    for (std::size_t l = 0; l < lanes; ++l) pixel[a * lanes + l] += multiplier[l] * ones[a * lanes + l];
  }
  for (std::size_t a = n; a-- > 0;) {
    const float* const row = matrix + a * (a + 1) / 2 * lanes;
    float* const weight = batch.weight.data() + a * lanes;
#pragma omp simd
    for (std::size_t l = 0; l < lanes; ++l) weight[l] = pixel[a * lanes + l] * row[a * lanes + l];
    for (std::size_t k = 0; k < a; ++k) {
#pragma omp simd
      for (std::size_t l = 0; l < lanes; ++l) pixel[k * lanes + l] -= row[k * lanes + l] * weight[l];
    }
  }
}

}  // namespace abn::harness
