#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <thread>
#include <vector>

#include "embed/embed_fixtures.hpp"
#include "support/count_allocations.hpp"

namespace corotet {
namespace {

template <class K>
class EmbedBuffer : public EmbedFixture<K> {
 protected:
  /// Enough vertices, so that updates have several ranges, and a motion that uses everything.
  EmbedBuffer() {
    const Points inside = this->inside(mesh_, 1500), outside = this->around(100);
    Points points = inside;
    points.insert(points.end(), outside.begin(), outside.end());
    surface_.emplace_back(K::Surface::bind(mesh_, points, this->directions(1600)).value());
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      u_.push_back(this->random_vector(0.2).template cast<typename K::Scalar>());
  }
  typename K::Surface& surface() { return surface_.front(); }

  typename K::Mesh mesh_ = this->block();
  std::vector<typename K::Surface> surface_;
  Field<typename K::Scalar> u_;
};
TYPED_TEST_SUITE(EmbedBuffer, AllKinds);

constexpr auto canary = std::byte{0xA5};

Vec3<float> load(const std::byte* where) {
  float xyz[3];
  std::memcpy(xyz, where, sizeof xyz);
  return {xyz[0], xyz[1], xyz[2]};
}

TYPED_TEST(EmbedBuffer, WritesItsAttributesAtAnyStrideAndNothingElse) {
  USE_KIND;
  const Field<Scalar> x = this->positions(this->surface(), this->u_), n = this->normals(this->surface(), this->u_);
  struct Layout {
    std::size_t stride, position, normal, start;
  };
  constexpr std::size_t none = VertexBuffer::none;
  for (const Layout& layout : {Layout{24, 0, 12, 0}, Layout{32, 12, 0, 0}, Layout{37, 3, 17, 1}, Layout{25, 13, 1, 3},
                               Layout{12, 0, none, 2}, Layout{19, none, 7, 0}, Layout{15, none, none, 0}}) {
    std::vector<std::byte> bytes(layout.start + layout.stride * x.size() + 5, canary);
    VertexBuffer buffer;
    buffer.data = bytes.data() + layout.start;
    buffer.stride = layout.stride;
    buffer.count = size_of(x);
    buffer.position_offset = layout.position;
    buffer.normal_offset = layout.normal;
    this->surface().update(this->u_, buffer);
    const auto take = [&](std::size_t vertex, std::size_t offset, const Vec3<Scalar>& expected) {
      if (offset == none) return;
      std::byte* where = buffer.data + vertex * layout.stride + offset;
      EXPECT_EQ(load(where), expected.template cast<float>());
      std::fill_n(where, 3 * sizeof(float), canary);
    };
    for (std::size_t v = 0; v < x.size(); ++v) {
      take(v, layout.position, x[v]);
      take(v, layout.normal, n[v]);
    }
    EXPECT_EQ(std::count(bytes.begin(), bytes.end(), canary), std::ssize(bytes)) << "a byte between was written";
  }
}

TYPED_TEST(EmbedBuffer, TranslationIsAddedInTheMeshPrecision) {
  USE_KIND;
  const Field<Scalar> x = this->positions(this->surface(), this->u_);
  std::vector<std::byte> bytes(12 * x.size());
  VertexBuffer buffer{bytes.data(), 12, size_of(x), 0, VertexBuffer::none, {1e3, -0.5, 2}};
  this->surface().update(this->u_, buffer);
  for (std::size_t v = 0; v < x.size(); ++v)
    EXPECT_EQ(load(bytes.data() + 12 * v), (x[v] + buffer.translation.template cast<Scalar>()).template cast<float>());
}

TYPED_TEST(EmbedBuffer, UpdateAllocatesNothing) {
  std::vector<std::byte> bytes(24 * at(this->surface().vertex_count()));
  VertexBuffer buffer{bytes.data(), 24, this->surface().vertex_count(), 0, 12};
  const auto& constant = this->surface();
  auto scratch = constant.make_scratch();
  const long before = testing::allocation_count;
  this->surface().update(this->u_, buffer);
  this->surface().update(this->u_, buffer, SerialExecutor{});
  constant.update(this->u_, buffer, scratch);
  buffer.conversion = CoordinateConversion::between(coordinates::z_up, coordinates::unreal);
  this->surface().update(this->u_, buffer);
  EXPECT_EQ(testing::allocation_count, before);
  const std::vector<int> counted(10);
  EXPECT_EQ(testing::allocation_count, before + 1) << "the counter does not count";
}

TYPED_TEST(EmbedBuffer, SameBytesOnAnyNumberOfThreads) {
  std::vector<std::byte> expected(24 * at(this->surface().vertex_count()));
  VertexBuffer buffer{expected.data(), 24, this->surface().vertex_count(), 0, 12};
  this->surface().update(this->u_, buffer);
  for (const Index threads : {1, 2, 4}) {
    const auto executor = [threads](Index count, TaskRef task) {
      std::vector<std::thread> pool;
      for (Index t = 0; t < threads; ++t)
        pool.emplace_back([&, t] {
          for (Index i = count - 1 - t; i >= 0; i -= threads) task(i);  // backwards, to be unlike the serial order
        });
      for (std::thread& thread : pool) thread.join();
    };
    std::vector<std::byte> bytes(expected.size(), canary);
    buffer.data = bytes.data();
    this->surface().update(this->u_, buffer, executor);
    EXPECT_EQ(bytes, expected);
  }
}

// Bodies of one mesh, each with its copy of the surface, are updated at once as they would be alone.
TYPED_TEST(EmbedBuffer, CopiesServeBodiesAtOnce) {
  USE_KIND;
  constexpr std::size_t bodies = 4;
  constexpr int rounds = 30;
  const Surface& original = this->surface();
  const Index count = original.vertex_count();
  std::vector<Field<Scalar>> u(bodies);
  for (Field<Scalar>& field : u)
    for (std::size_t v = 0; v < this->u_.size(); ++v) field.push_back(this->random_vector(0.2).template cast<Scalar>());
  const auto buffer_of = [&](std::vector<std::byte>& bytes) { return VertexBuffer{bytes.data(), 24, count, 0, 12}; };
  std::vector<std::vector<std::byte>> alone(bodies, std::vector<std::byte>(24 * at(count))), copied = alone,
                                                                                             constant = alone;
  for (std::size_t b = 0; b < bodies; ++b) {
    Surface own = Surface(original);
    own.update(u[b], buffer_of(alone[b]));
    EXPECT_EQ(alone[b] == alone[0], b == 0);
  }
  std::vector<Surface> copies(bodies, original);
  std::vector<std::thread> threads;
  for (std::size_t b = 0; b < bodies; ++b)
    threads.emplace_back([&, b] {
      auto scratch = original.make_scratch();
      for (int round = 0; round < rounds; ++round) {
        copies[b].update(u[b], buffer_of(copied[b]));
        original.update(u[b], buffer_of(constant[b]), scratch);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(copied, alone);
  EXPECT_EQ(constant, alone);
}

TYPED_TEST(EmbedBuffer, ACopyCostsItsScratch) {
  USE_KIND;
  const Points points = this->inside(this->mesh_, 5000), normals = this->directions(5000);
  const long live_before = testing::live_bytes;
  auto surface = Surface::bind(this->mesh_, points, normals);
  ASSERT_TRUE(surface.ok());
  // What the allocator rounds up, large blocks to whole pages, and the counter of owners.
  constexpr long rounding = 4 * 4096;
  const MemoryUse memory = surface->memory();
  EXPECT_GE(testing::live_bytes - live_before, static_cast<long>(memory.shared + memory.owned));
  EXPECT_LE(testing::live_bytes - live_before, static_cast<long>(memory.shared + memory.owned) + rounding);
  EXPECT_GT(memory.shared, 5 * memory.owned);  // one scratch entry an element, 35 vertices an element

  constexpr std::size_t count = 1000;
  std::vector<Surface> copies;
  copies.reserve(count);
  const long before = testing::allocated_bytes;
  for (std::size_t i = 0; i < count; ++i) copies.push_back(*surface);
  const auto asked = static_cast<std::size_t>(testing::allocated_bytes - before);
  EXPECT_GE(asked, count * memory.owned);
  EXPECT_LT(asked, count * (memory.owned + detail::RawBuffer::alignment)) << "sizes that are aligned are rounded up";
  for (const Surface& copy : copies) EXPECT_TRUE(copy.shares_binding(*surface));
  EXPECT_FALSE(surface->shares_binding(this->surface()));
}

// A copy lives on when what it was copied from is gone.
TYPED_TEST(EmbedBuffer, CopiesOutliveTheOriginal) {
  USE_KIND;
  const Field<Scalar> expected = this->positions(this->surface(), this->u_);
  Surface copy = this->surface();
  this->surface_.clear();
  EXPECT_EQ(this->positions(copy, this->u_), expected);
}

}  // namespace
}  // namespace corotet
