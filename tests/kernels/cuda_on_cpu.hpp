// CUDA's words for a C++ compiler: intrinsics that round once, and the threads of one warp at a time.  Its includes come first.
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>

#define __global__
#define __device__
#define __forceinline__ inline
#define __launch_bounds__(threads)
#define __shared__ static

struct Place { unsigned x; };
static thread_local Place blockIdx, blockDim, threadIdx;

extern "C" void cutpoint_stand(unsigned block, unsigned threads, unsigned thread) {
  blockIdx.x = block;
  blockDim.x = threads;
  threadIdx.x = thread;
}

static std::mutex door;
static std::condition_variable bell;
static unsigned warp, waiting, turn;

// how many threads wait for each other from here on
extern "C" void cutpoint_gather(unsigned threads) { warp = threads; }

static inline void __syncwarp() {
  std::unique_lock<std::mutex> held(door);
  const unsigned now = turn;
  if (++waiting < warp) {
    bell.wait(held, [now] { return turn != now; });
    return;
  }
  waiting = 0;
  ++turn;
  bell.notify_all();
}

static inline double __dadd_rn(double a, double b) { return a + b; }
static inline double __dsub_rn(double a, double b) { return a - b; }
static inline double __dmul_rn(double a, double b) { return a * b; }
static inline double __ddiv_rn(double a, double b) { return a / b; }
static inline double __dsqrt_rn(double a) { return std::sqrt(a); }
static inline double __fma_rn(double a, double b, double c) { return std::fma(a, b, c); }

static inline long long __double_as_longlong(double x) {
  long long bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline double __longlong_as_double(long long bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

static inline float __fadd_rn(float a, float b) { return a + b; }
static inline float __fsub_rn(float a, float b) { return a - b; }
static inline float __fmul_rn(float a, float b) { return a * b; }
static inline float __fdiv_rn(float a, float b) { return a / b; }
static inline float __fsqrt_rn(float a) { return std::sqrt(a); }
static inline float __fmaf_rn(float a, float b, float c) { return std::fma(a, b, c); }

static inline int __float_as_int(float x) {
  int bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline float __int_as_float(int bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
