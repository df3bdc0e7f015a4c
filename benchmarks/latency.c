/* The harness of latency.py, which puts a function's header, recorded inputs and call in its places. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "HEADER"

/* TABLES */

#define BINS 1000000 /* of a nanosecond each; what takes longer counts in the last */
#define PAINTED 65536

static unsigned long allocations;
void *__real_malloc(size_t);
void *__real_calloc(size_t, size_t);
void *__real_realloc(void *, size_t);
void *__wrap_malloc(size_t n) { allocations++; return __real_malloc(n); }
void *__wrap_calloc(size_t m, size_t n) { allocations++; return __real_calloc(m, n); }
void *__wrap_realloc(void *p, size_t n) { allocations++; return __real_realloc(p, n); }

static uint32_t histogram[BINS];
static double cutpoint_out[CUTPOINT_OUTPUTS];

static uint64_t now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static __attribute__((noinline)) void call(const double *cutpoint_in) {
  /* CALL */
}

static __attribute__((noinline)) void paint(void) {
  volatile unsigned char stack[PAINTED];
  for (size_t k = 0; k < PAINTED; k++) stack[k] = 0xa5;
}

/* the same stack as paint's, looked at again: what is no longer painted was used */
static __attribute__((noinline)) size_t washed(void) {
  volatile unsigned char stack[PAINTED];
  size_t k = 0;
  __asm__ volatile("" : : "r"(stack) : "memory");
  while (k < PAINTED && stack[k] == 0xa5) k++;
  return PAINTED - k;
}

static long percentile(double share, long calls) {
  double seen = 0;
  for (long k = 0; k < BINS; k++) {
    seen += histogram[k];
    if (seen >= share * (double)calls) return k;
  }
  return BINS;
}

int main(int count, char **arguments) {
  const long calls = count > 1 ? atol(arguments[1]) : 100000000;
  uint64_t worst = 0, clock = UINT64_MAX;
  paint();
  call(cutpoint_inputs[1]);
  const size_t stack = washed();
  for (int k = 0; k < 100000; k++) {
    const uint64_t start = now(), taken = now() - start;
    if (taken < clock) clock = taken;
  }
  const unsigned long before = allocations;
  for (long k = 0; k < calls; k++) {
    const uint64_t start = now();
    call(cutpoint_inputs[k % CUTPOINT_CASES]);
    const uint64_t taken = now() - start - clock;
    const uint64_t length = (int64_t)taken < 0 ? 0 : taken;
    histogram[length < BINS ? length : BINS - 1]++;
    if (length > worst) worst = length;
  }
  printf("{\"p50\": %ld, \"p99.99\": %ld, \"max\": %llu, \"calls\": %ld, \"allocations\": %lu, \"stack\": %zu}\n",
         percentile(0.5, calls), percentile(0.9999, calls), (unsigned long long)worst, calls, allocations - before,
         stack);
  return 0;
}
