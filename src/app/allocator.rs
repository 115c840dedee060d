//! Memory that is freed goes back to the system.
//!
//! A window that is open for hours captures thousands of frames, and each frees the pictures of the one before. GNU's
//! allocator does not return such memory: once it has seen a large block freed it no longer maps blocks of that size
//! (up to 32 MiB) on their own, and each thread that the driver starts has a heap of its own whose holes nothing fills.
//! After half an hour of use this retained hundreds of MiB. With a fixed threshold and few heaps, pictures are mapped,
//! and unmapped when they are dropped; the kernel's zeroed pages cost far less than computing what is written to them.

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod gnu {
    /// Blocks of this many bytes and more are mapped on their own: a snapshot of 256×128 pixels.
    const MAPPED_FROM: i32 = 128 << 10;
    /// How many heaps all threads share.
    const HEAPS: i32 = 2;

    /// Sets glibc's allocator for the whole process: blocks of 128 KiB and more are mapped on their own, so that they
    /// go back to the system as soon as they are freed, and all threads share two heaps.
    #[expect(unsafe_code, reason = "glibc's own switches: any thread may set them at any time")]
    pub fn give_back_at_once() {
        // An option that a libc does not know it refuses, and nothing changes.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, MAPPED_FROM);
            libc::mallopt(libc::M_ARENA_MAX, HEAPS);
        }
    }

    /// Returns free pages of glibc's heaps to the system, also those between blocks that are in use.
    #[expect(unsafe_code, reason = "glibc locks its heaps while it looks for pages that nothing uses")]
    pub fn give_back() {
        unsafe {
            libc::malloc_trim(0);
        }
    }
}

/// Sets up the process's allocator so that freed blocks of 128 KiB and more go back to the system at once, with two
/// heaps for all threads; call it before anything large is allocated. Does nothing where the allocator is not glibc's.
#[cfg(not(target_family = "wasm"))]
pub fn give_back_at_once() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    gnu::give_back_at_once();
}

/// Returns free memory between small blocks that are in use: 1 to 20 ms, in which other threads may wait for memory.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    gnu::give_back();
}
