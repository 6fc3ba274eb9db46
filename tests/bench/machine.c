/* SPDX-License-Identifier: Apache-2.0 */
#include "machine.h"

#include <stdbool.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The value of the first line "KEY : VALUE" of /proc/cpuinfo. */
static void read_cpu(const char *key, char *value, size_t size) {
  char line[8192];
  value[0] = 0;
  FILE *file = fopen("/proc/cpuinfo", "r");
  while (file && !value[0] && fgets(line, sizeof line, file)) {
    char *colon = strchr(line, ':');
    if (colon && strncmp(line, key, strlen(key)) == 0) {
      line[strcspn(line, "\n")] = 0;
      snprintf(value, size, "%s", colon + 1 + strspn(colon + 1, " "));
    }
  }
  if (file) {
    fclose(file);
  }
}

static bool has_flag(const char *flags, const char *flag) {
  const size_t length = strlen(flag);
  for (const char *at = strstr(flags, flag); at; at = strstr(at + 1, flag)) {
    if ((at == flags || at[-1] == ' ') && (at[length] == ' ' || !at[length])) {
      return true;
    }
  }
  return false;
}

static void describe_caches(FILE *file) {
  static const char *const names[] = {"level", "type", "size"};
  const char *between = "# caches of core 0:";
  for (int i = 0; i < 8; i++) {
    char values[3][64] = {"", "", ""};
    for (int k = 0; k < 3; k++) {
      char path[128];
      snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/%s", i, names[k]);
      FILE *source = fopen(path, "r");
      if (source) {
        if (fgets(values[k], sizeof values[k], source)) {
          values[k][strcspn(values[k], "\n")] = 0;
        }
        fclose(source);
      }
    }
    if (values[2][0] && strcmp(values[1], "Instruction") != 0) {
      fprintf(file, "%s L%s %s", between, values[0], values[2]);
      between = ",";
    }
  }
  if (between[0] == ',') {
    fprintf(file, "\n");
  }
}

void machine_describe(FILE *file) {
  static const char *const flags[] = {"hypervisor", "sse4_2",   "avx",      "avx2", "fma",
                                      "avx512f",    "avx512dq", "avx512vl", "asimd"};
  char model[256], family[64], number[64], features[8192];
  read_cpu("model name", model, sizeof model);
  read_cpu("cpu family", family, sizeof family);
  read_cpu("model\t", number, sizeof number);
  read_cpu("flags", features, sizeof features);
  if (!features[0]) {
    read_cpu("Features", features, sizeof features);
  }
  char date[32];
  time_t now = time(NULL);
  strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
  fprintf(file, "# date: %s\n", date);
  if (model[0]) {
    fprintf(file, family[0] ? "# processor: %s, family %s, model %s\n" : "# processor: %s\n", model, family, number);
  }
  fprintf(file, "# processors: %ld\n", sysconf(_SC_NPROCESSORS_ONLN));
  fprintf(file, "# memory: %.0f GiB\n", (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGE_SIZE) / 0x1p30);
  describe_caches(file);
  fprintf(file, "# of its features:");
  for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
    fprintf(file, "%s%s", has_flag(features, flags[i]) ? " " : "", has_flag(features, flags[i]) ? flags[i] : "");
  }
  fprintf(file, "\n# compiler: %s\n", BENCH_COMPILER);
}

void machine_load(FILE *file, const char *when) {
  char line[128] = "";
  FILE *source = fopen("/proc/loadavg", "r");
  if (source) {
    if (fgets(line, sizeof line, source)) {
      line[strcspn(line, " ")] = 0;
      fprintf(file, "# load %s: %s\n", when, line);
    }
    fclose(source);
  }
}
