// For LD_PRELOAD: a disk on which nothing ever becomes durable.
#include <unistd.h>

extern "C" int fsync(int /*file*/) {
  for (;;) ::pause();
}
