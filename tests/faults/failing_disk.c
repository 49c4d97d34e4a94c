/* A disk that fails at the n-th of its calls: writes (half of one is made first), syncs, renames,
   and whatever cuts or removes files. Preloaded into a process, so that SQLite meets it as well.

   disk_fails(kinds, at, on): from now the `at`-th call (from 1) of these kinds fails, and with
   `on` every later one too; 0 never fails. disk_calls(): how many there were since. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum { WRITES = 1, SYNCS = 2, RENAMES = 4, CUTS = 8 };
static int wanted, failing_at, goes_on, calls;

void disk_fails(int kinds, int at, int on) { wanted = kinds, failing_at = at, goes_on = on, calls = 0; }
int disk_calls(void) { return calls; }

static int fails(int kind, int error) {
    if (!(wanted & kind)) return 0;
    calls++;
    if (!failing_at || calls < failing_at || (calls > failing_at && !goes_on)) return 0;
    errno = error;
    return 1;
}

#define REAL(name) __typeof__(name) *real = (__typeof__(name) *)dlsym(RTLD_NEXT, #name)

static int is_file(int file) {
    struct stat found;
    return fstat(file, &found) == 0 && S_ISREG(found.st_mode);
}

ssize_t write(int file, const void *data, size_t size) {
    REAL(write);
    if (is_file(file) && fails(WRITES, ENOSPC)) {
        if (size > 1 && real(file, data, size / 2) < 0) return -1;
        errno = ENOSPC;
        return -1;
    }
    return real(file, data, size);
}

#define PWRITE(name, offset_type)                                                        \
    ssize_t name(int file, const void *data, size_t size, offset_type place) {            \
        REAL(name);                                                                        \
        if (fails(WRITES, ENOSPC)) {                                                       \
            if (size > 1 && real(file, data, size / 2, place) < 0) return -1;              \
            errno = ENOSPC;                                                                \
            return -1;                                                                     \
        }                                                                                  \
        return real(file, data, size, place);                                              \
    }
PWRITE(pwrite, off_t)
PWRITE(pwrite64, off64_t)

/* Syncs that do not fail cost time and show nothing here: no machine is lost. */
int fsync(int file) { (void)file; return fails(SYNCS, EIO) ? -1 : 0; }
int fdatasync(int file) { (void)file; return fails(SYNCS, EIO) ? -1 : 0; }
int rename(const char *from, const char *to) {
    REAL(rename);
    return fails(RENAMES, EIO) ? -1 : real(from, to);
}
int renameat(int f, const char *from, int t, const char *to) {
    REAL(renameat);
    return fails(RENAMES, EIO) ? -1 : real(f, from, t, to);
}
int ftruncate(int file, off_t size) { REAL(ftruncate); return fails(CUTS, EIO) ? -1 : real(file, size); }
int ftruncate64(int file, off64_t size) { REAL(ftruncate64); return fails(CUTS, EIO) ? -1 : real(file, size); }
int unlink(const char *path) { REAL(unlink); return fails(CUTS, EIO) ? -1 : real(path); }
int unlinkat(int f, const char *path, int how) { REAL(unlinkat); return fails(CUTS, EIO) ? -1 : real(f, path, how); }
