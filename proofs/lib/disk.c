/* Stands between a program and its disk: notes every write and sync of the files below DISK_ROOT, and lets chosen ones fail.
 *
 * DISK_LOG: a file that gets a record for each operation, in their order (struct record, then its bytes).
 * DISK_CONTROL: a file of 64-bit numbers, shared with whoever wants faults (struct control).
 * Reads are only failed, not noted; locks and the shared memory of the write-ahead log's index are passed on unseen. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

enum { WRITE = 1, SYNC = 2, OPEN = 4, TRUNCATE = 8, UNLINK = 16, READ = 32 };
enum { FILES = 4096 };

struct record { uint32_t operation; uint32_t file; int64_t result; uint64_t offset; uint64_t length; };

/* The operation that counts `wait` down to zero fails with `error`, and so do the `more` after it. */
struct control { int64_t mask, wait, error, more, hits, torn, seen[32]; };

static pthread_mutex_t one = PTHREAD_MUTEX_INITIALIZER;
static char watched[FILES];
static int log_fd = -1;
static struct control *control;
static const char *root;

static ssize_t (*real_pwrite)(int, const void *, size_t, off_t);
static ssize_t (*real_pread)(int, void *, size_t, off_t);
static ssize_t (*real_write)(int, const void *, size_t);
static int (*real_fsync)(int), (*real_fdatasync)(int), (*real_close)(int), (*real_unlink)(const char *);
static int (*real_open)(const char *, int, ...), (*real_ftruncate)(int, off_t);

__attribute__((constructor)) static void prepare(void) {
    real_pwrite = dlsym(RTLD_NEXT, "pwrite64");
    real_pread = dlsym(RTLD_NEXT, "pread64");
    real_write = dlsym(RTLD_NEXT, "write");
    real_fsync = dlsym(RTLD_NEXT, "fsync");
    real_fdatasync = dlsym(RTLD_NEXT, "fdatasync");
    real_close = dlsym(RTLD_NEXT, "close");
    real_unlink = dlsym(RTLD_NEXT, "unlink");
    real_open = dlsym(RTLD_NEXT, "open64");
    real_ftruncate = dlsym(RTLD_NEXT, "ftruncate64");
    root = getenv("DISK_ROOT");
    const char *path = getenv("DISK_LOG");
    if (path) log_fd = real_open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    path = getenv("DISK_CONTROL");
    int fd = path ? real_open(path, O_RDWR | O_CLOEXEC, 0) : -1;
    if (fd >= 0) {
        void *at = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        if (at != MAP_FAILED) control = at;
        real_close(fd);
    }
}

static int is_watched(int fd) { return fd >= 0 && fd < FILES && watched[fd]; }

static int below_root(const char *path) {
    size_t length = root ? strlen(root) : 0;
    /* The index of the write-ahead log is shared memory: nothing in it needs to survive. */
    return length && strncmp(path, root, length) == 0 && !strstr(path, "-shm");
}

static void note(uint32_t operation, int file, int64_t result, uint64_t offset, const void *bytes, uint64_t length) {
    if (log_fd < 0) return;
    struct record record = {operation, (uint32_t)file, result, offset, length};
    if (real_write(log_fd, &record, sizeof record) < 0) abort();
    if (length && real_write(log_fd, bytes, length) < 0) abort();
}

/* Shall this operation fail? With which error? */
static int fault(int operation) {
    if (!control) return 0;
    int bit = __builtin_ctz((unsigned)operation);
    control->seen[bit]++;
    if (!(control->mask & operation)) return 0;
    if (control->wait > 1) { control->wait--; return 0; }
    if (control->wait == 1) { control->wait = 0; control->hits++; return (int)control->error; }
    if (control->wait == 0 && control->more > 0) { control->more--; control->hits++; return (int)control->error; }
    return 0;
}

static ssize_t do_write(int fd, const void *bytes, size_t length, off_t offset) {
    if (!is_watched(fd)) return real_pwrite(fd, bytes, length, offset);
    pthread_mutex_lock(&one);
    int error = fault(WRITE);
    ssize_t written = -1;
    if (error) {
        if (control->torn && length > 1 && real_pwrite(fd, bytes, length / 2, offset) > 0)
            note(WRITE, fd, (int64_t)(length / 2), (uint64_t)offset, bytes, length / 2);
        errno = error;
    } else {
        written = real_pwrite(fd, bytes, length, offset);
        if (written > 0) note(WRITE, fd, written, (uint64_t)offset, bytes, (uint64_t)written);
    }
    int keep = errno;
    pthread_mutex_unlock(&one);
    errno = keep;
    return written;
}

ssize_t pwrite(int fd, const void *bytes, size_t length, off_t offset) { return do_write(fd, bytes, length, offset); }
ssize_t pwrite64(int fd, const void *bytes, size_t length, off64_t offset) { return do_write(fd, bytes, length, offset); }

ssize_t write(int fd, const void *bytes, size_t length) {
    if (!is_watched(fd)) return real_write(fd, bytes, length);
    off_t offset = lseek(fd, 0, SEEK_CUR);
    ssize_t written = do_write(fd, bytes, length, offset);
    if (written > 0) lseek(fd, offset + written, SEEK_SET);
    return written;
}

static ssize_t do_read(int fd, void *bytes, size_t length, off_t offset) {
    if (!is_watched(fd)) return real_pread(fd, bytes, length, offset);
    pthread_mutex_lock(&one);
    int error = fault(READ);
    pthread_mutex_unlock(&one);
    if (!error) return real_pread(fd, bytes, length, offset);
    errno = error;
    return -1;
}

ssize_t pread(int fd, void *bytes, size_t length, off_t offset) { return do_read(fd, bytes, length, offset); }
ssize_t pread64(int fd, void *bytes, size_t length, off64_t offset) { return do_read(fd, bytes, length, offset); }

static int do_sync(int fd, int (*real)(int)) {
    if (!is_watched(fd)) return real(fd);
    pthread_mutex_lock(&one);
    int error = fault(SYNC);
    int result = error ? -1 : real(fd);
    if (error) errno = error;
    note(SYNC, fd, result, 0, NULL, 0);
    int keep = errno;
    pthread_mutex_unlock(&one);
    errno = keep;
    return result;
}

int fsync(int fd) { return do_sync(fd, real_fsync); }
int fdatasync(int fd) { return do_sync(fd, real_fdatasync); }

static int do_truncate(int fd, off_t length) {
    if (!is_watched(fd)) return real_ftruncate(fd, length);
    pthread_mutex_lock(&one);
    int error = fault(TRUNCATE);
    int result = error ? -1 : real_ftruncate(fd, length);
    if (error) errno = error;
    else note(TRUNCATE, fd, result, (uint64_t)length, NULL, 0);
    int keep = errno;
    pthread_mutex_unlock(&one);
    errno = keep;
    return result;
}

int ftruncate(int fd, off_t length) { return do_truncate(fd, length); }
int ftruncate64(int fd, off64_t length) { return do_truncate(fd, length); }

static int do_open(const char *path, int flags, mode_t mode) {
    if (!below_root(path)) return real_open(path, flags, mode);
    pthread_mutex_lock(&one);
    int error = fault(OPEN);
    int fd = error ? -1 : real_open(path, flags, mode);
    if (error) errno = error;
    if (fd >= 0 && fd < FILES) {
        watched[fd] = 1;
        note(OPEN, fd, fd, (uint64_t)flags, path, strlen(path));
    }
    int keep = errno;
    pthread_mutex_unlock(&one);
    errno = keep;
    return fd;
}

static mode_t mode_of(int flags, va_list more) { return flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0; }
#define OPENS(name) \
    int name(const char *path, int flags, ...) { \
        va_list more; \
        va_start(more, flags); \
        mode_t mode = mode_of(flags, more); \
        va_end(more); \
        return do_open(path, flags, mode); \
    }
OPENS(open)
OPENS(open64)

int close(int fd) {
    if (is_watched(fd)) watched[fd] = 0;
    return real_close(fd);
}

int unlink(const char *path) {
    if (!below_root(path)) return real_unlink(path);
    pthread_mutex_lock(&one);
    int result = real_unlink(path);
    note(UNLINK, 0, result, 0, path, strlen(path));
    int keep = errno;
    pthread_mutex_unlock(&one);
    errno = keep;
    return result;
}
