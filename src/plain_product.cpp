#include "plain_product.hpp"

namespace corotet::program {

void plain_product(const BlockMatrix<float>& matrix, const Field<float>& x, Field<float>& y) {
  const BlockPattern& p = matrix.pattern();
  for (Index i = 0; i < matrix.rows(); ++i) {
    float sum0 = 0, sum1 = 0, sum2 = 0;
    for (Index k = p.row_start[at(i)]; k < p.row_start[at(i) + 1]; ++k) {
      const float* a = matrix.values(k);
      const Vec3<float>& v = x[at(p.column[at(k)])];
      sum0 += a[0] * v[0] + a[3] * v[1] + a[6] * v[2];
      sum1 += a[1] * v[0] + a[4] * v[1] + a[7] * v[2];
      sum2 += a[2] * v[0] + a[5] * v[1] + a[8] * v[2];
    }
    y[at(i)] = {sum0, sum1, sum2};
  }
}

}  // namespace corotet::program
