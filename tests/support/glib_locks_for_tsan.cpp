// Tells ThreadSanitizer of GLib's locks, which it cannot see: most of them are futexes, and GLib is
// not instrumented. Stands before GLib in the order of libraries, so that GStreamer and its plugins
// call these functions; they call GLib's and say what follows from it: what one thread did before
// it gave a lock back, another that takes it has seen. So our code in GStreamer's threads is
// checked by the order there really is.
#include <dlfcn.h>
#include <glib.h>
#include <sanitizer/tsan_interface.h>

namespace {

/// GLib's own function of that name.
template <typename Function>
Function* of_glib(Function* /*ours*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

#define GIMBAL_OF_GLIB(function) \
  static const auto of_glib_##function = of_glib(&(function), #function)

#define GIMBAL_LOCK(function, Lock)      \
  extern "C" void function(Lock* lock) { \
    GIMBAL_OF_GLIB(function);            \
    of_glib_##function(lock);            \
    __tsan_acquire(lock);                \
  }

#define GIMBAL_TRYLOCK(function, Lock)                  \
  extern "C" gboolean function(Lock* lock) {            \
    GIMBAL_OF_GLIB(function);                           \
    const gboolean is_taken = of_glib_##function(lock); \
    if (is_taken) __tsan_acquire(lock);                 \
    return is_taken;                                    \
  }

#define GIMBAL_UNLOCK(function, Lock)    \
  extern "C" void function(Lock* lock) { \
    GIMBAL_OF_GLIB(function);            \
    __tsan_release(lock);                \
    of_glib_##function(lock);            \
  }

GIMBAL_LOCK(g_mutex_lock, GMutex)
GIMBAL_TRYLOCK(g_mutex_trylock, GMutex)
GIMBAL_UNLOCK(g_mutex_unlock, GMutex)
GIMBAL_LOCK(g_rec_mutex_lock, GRecMutex)
GIMBAL_TRYLOCK(g_rec_mutex_trylock, GRecMutex)
GIMBAL_UNLOCK(g_rec_mutex_unlock, GRecMutex)
GIMBAL_LOCK(g_rw_lock_reader_lock, GRWLock)
GIMBAL_TRYLOCK(g_rw_lock_reader_trylock, GRWLock)
GIMBAL_UNLOCK(g_rw_lock_reader_unlock, GRWLock)
GIMBAL_LOCK(g_rw_lock_writer_lock, GRWLock)
GIMBAL_TRYLOCK(g_rw_lock_writer_trylock, GRWLock)
GIMBAL_UNLOCK(g_rw_lock_writer_unlock, GRWLock)

// Waiting gives the mutex back and takes it again.

extern "C" void g_cond_wait(GCond* cond, GMutex* mutex) {
  GIMBAL_OF_GLIB(g_cond_wait);
  __tsan_release(mutex);
  of_glib_g_cond_wait(cond, mutex);
  __tsan_acquire(mutex);
}

extern "C" gboolean g_cond_wait_until(GCond* cond, GMutex* mutex, gint64 end_time) {
  GIMBAL_OF_GLIB(g_cond_wait_until);
  __tsan_release(mutex);
  const gboolean is_signalled = of_glib_g_cond_wait_until(cond, mutex, end_time);
  __tsan_acquire(mutex);
  return is_signalled;
}
