// Pinocchio's regressor and inverse dynamics in a loop, for
// benches/against_pinocchio_native.py.
//
// Compiled against the headers alone: linking with the library of the wheel would mix two
// alignments of Eigen (this is built for the processor at hand, the library is not).
// Arguments: files with n and, a joint a line, its antecedent (from 0, -1 is the base), axis,
// rotation (row by row) and translation. Prints ns per call: regressor, rnea, and regressor with
// each result copied behind the one before, as Pinocchio has it (columns first), in the cache
// and in memory. Without a file: the rate of stores past the cache, GB/s: of numbers, and of
// lines of zeros.
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <vector>

using namespace pinocchio;

static double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * t.tv_sec + t.tv_nsec;
}

static Model read(const char *path) {
  std::ifstream file(path);
  int n;
  file >> n;
  Model model;
  for (int i = 0; i < n; i++) {
    int parent;
    Eigen::Vector3d axis;
    SE3 place = SE3::Identity();
    file >> parent;
    for (int k = 0; k < 3; k++) file >> axis[k];
    for (int k = 0; k < 9; k++) file >> place.rotation()(k / 3, k % 3);
    for (int k = 0; k < 3; k++) file >> place.translation()[k];
    std::string name = "joint " + std::to_string(i);
    JointIndex id;
    if (axis[0] == 1) id = model.addJoint(parent + 1, JointModelRX(), place, name);
    else if (axis[1] == 1) id = model.addJoint(parent + 1, JointModelRY(), place, name);
    else if (axis[2] == 1) id = model.addJoint(parent + 1, JointModelRZ(), place, name);
    else id = model.addJoint(parent + 1, JointModelRevoluteUnaligned(axis), place, name);
    model.appendBodyToJoint(id, Inertia::Random(), SE3::Identity());
  }
  return model;
}

// Stores past the cache into memory that has been touched, the best of some rounds. Lines of
// zeros go nearly twice as fast as others on some processors.
static double stores(bool zeros) {
  const size_t size = size_t(256) << 20;
  double *to = static_cast<double *>(std::aligned_alloc(64, size));
  std::fill(to, to + size / 8, 1.0);
  double best = 0;
  for (int round = 1; round < 8; round++) {
    double start = now(), number = zeros ? 0 : round;
#if defined(__AVX512F__)
    __m512d x = _mm512_set1_pd(number);
    for (size_t i = 0; i < size / 8; i += 8) _mm512_stream_pd(to + i, x);
    _mm_sfence();
#elif defined(__AVX2__)
    __m256d x = _mm256_set1_pd(number);
    for (size_t i = 0; i < size / 8; i += 4) _mm256_stream_pd(to + i, x);
    _mm_sfence();
#else
    std::fill(to, to + size / 8, number);
#endif
    best = std::max(best, size / (now() - start));
  }
  std::free(to);
  return best;
}

struct States {
  std::vector<Eigen::VectorXd> q, v, a;
  States(const Model &model, int count) {
    for (int i = 0; i < count; i++) {
      q.push_back(Eigen::VectorXd::Random(model.nq));
      v.push_back(Eigen::VectorXd::Random(model.nv));
      a.push_back(Eigen::VectorXd::Random(model.nv));
    }
  }
};

// Stores W of as many samples as so many bytes hold, and at most 100 000, the best of some rounds.
static double filling(const Model &model, Data &data, const States &at, size_t bytes, int rounds) {
  const auto &row = data.jointTorqueRegressor;
  const size_t samples = std::min(size_t(100000), bytes / (8 * row.size())), count = at.q.size();
  std::vector<double> W(samples * row.size(), 1.0);
  double best = 1e18;
  for (int round = 0; round < rounds; round++) {
    double start = now();
    for (size_t i = 0; i < samples; i++) {
      const size_t k = i % count;
      computeJointTorqueRegressor(model, data, at.q[k], at.v[k], at.a[k]);
      std::copy_n(row.data(), row.size(), W.data() + i * row.size());
    }
    best = std::min(best, (now() - start) / samples);
  }
  return best;
}

int main(int count, char **paths) {
  if (count == 1) std::cout << stores(false) << ' ' << stores(true) << std::endl;
  const int states = 64, repeats = 10, rounds = 60;
  for (int k = 1; k < count; k++) {
    Model model = read(paths[k]);
    Data data(model);
    const States at(model, states);
    const auto &[q, v, a] = at;
    double regressor = 1e18, rnea = 1e18;
    volatile double used = 0;
    for (int round = 0; round < rounds; round++) {
      double start = now();
      for (int r = 0; r < repeats; r++)
        for (int i = 0; i < states; i++) {
          computeJointTorqueRegressor(model, data, q[i], v[i], a[i]);
          used = used + data.jointTorqueRegressor(0, 0);
        }
      double middle = now();
      for (int r = 0; r < repeats; r++)
        for (int i = 0; i < states; i++) {
          pinocchio::impl::rnea(model, data, q[i], v[i], a[i]);
          used = used + data.tau[0];
        }
      regressor = std::min(regressor, (middle - start) / (repeats * states));
      rnea = std::min(rnea, (now() - middle) / (repeats * states));
    }
    std::cout << regressor << " " << rnea << " ";
    std::cout << filling(model, data, at, size_t(5) << 17, 1000) << " ";
    std::cout << filling(model, data, at, size_t(512) << 20, 4) << std::endl;
  }
}
