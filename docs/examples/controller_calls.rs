// SPDX-License-Identifier: MIT

//! What the standard library has not: calls of the C library, and memory that owsd writes too.

use std::fs::File;
use std::io::{Error, Result};
use std::os::fd::AsRawFd;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

// Errors of Linux
pub const ENOENT: i32 = 2;
pub const EACCES: i32 = 13;
pub const EINVAL: i32 = 22;
pub const EROFS: i32 = 30;
pub const ERANGE: i32 = 34;
pub const EPROTO: i32 = 71;
pub const ECONNRESET: i32 = 104;
pub const EPERM: i32 = 1;
pub const EAGAIN: i32 = 11;
pub const ESTALE: i32 = 116;

pub fn error(number: i32) -> Error {
    Error::from_raw_os_error(number)
}

pub mod c {
    #[cfg(any(target_arch = "arm", target_arch = "aarch64"))]
    pub const O_DIRECTORY_NOFOLLOW: (i32, i32) = (0o40000, 0o100000);
    #[cfg(not(any(target_arch = "arm", target_arch = "aarch64")))]
    pub const O_DIRECTORY_NOFOLLOW: (i32, i32) = (0o200000, 0o400000);
    pub const SOCK_SEQPACKET_NONBLOCK_CLOEXEC: i32 = 5 | 0o4000 | 0o2000000;
    pub const MSG_NOSIGNAL: i32 = 0x4000;
    pub const MSG_CMSG_CLOEXEC: i32 = 0x40000000;
    pub const F_GET_SEALS: i32 = 1034;

    #[repr(C)]
    pub struct Part {
        pub base: *mut u8,
        pub len: usize,
    }
    #[repr(C)]
    pub struct Message {
        pub name: *mut u8,
        pub name_len: u32,
        pub parts: *mut Part,
        pub part_count: usize,
        pub control: *mut u8,
        pub control_len: usize,
        pub flags: i32,
    }
    #[repr(C)]
    pub struct Poll {
        pub fd: i32,
        pub events: i16,
        pub revents: i16,
    }
    extern "C" {
        pub fn socket(domain: i32, kind: i32, protocol: i32) -> i32;
        pub fn connect(fd: i32, address: *const u8, len: u32) -> i32;
        pub fn send(fd: i32, from: *const u8, len: usize, flags: i32) -> isize;
        pub fn recvmsg(fd: i32, message: *mut Message, flags: i32) -> isize;
        pub fn poll(fds: *mut Poll, count: usize, timeout: i32) -> i32;
        pub fn fcntl(fd: i32, what: i32, ...) -> i32;
        pub fn write(fd: i32, from: *const u8, len: usize) -> isize;
        pub fn mmap(at: *mut u8, len: usize, prot: i32, flags: i32, fd: i32, off: isize)
            -> *mut u8;
        pub fn munmap(at: *mut u8, len: usize) -> i32;
        pub fn clock_gettime(clock: i32, time: *mut [isize; 2]) -> i32;
        pub fn geteuid() -> u32;
    }
}

/// CLOCK_BOOTTIME.
pub fn now_ns() -> i64 {
    let mut time = [0isize; 2];
    unsafe { c::clock_gettime(7, &mut time) };
    time[0] as i64 * 1_000_000_000 + time[1] as i64
}

/// Memory that owsd writes too, so every access is atomic.
pub struct Map {
    pub base: *mut u8,
    pub size: u32,
}

impl Map {
    pub fn new(file: &File, size: u64, writable: bool) -> Result<Map> {
        if size < 256 || size > i32::MAX as u64 {
            return Err(error(EPROTO));
        }
        let (prot, fd) = (if writable { 3 } else { 1 }, file.as_raw_fd());
        let base = unsafe { c::mmap(std::ptr::null_mut(), size as usize, prot, 1, fd, 0) };
        if base as isize == -1 {
            return Err(Error::last_os_error());
        }
        Ok(Map { base, size: size as u32 })
    }

    pub fn inside(&self, off: u32, count: u32, size: u32) -> bool {
        off % 4 == 0 && off as u64 + count as u64 * size as u64 <= self.size as u64
    }

    pub fn word(&self, off: u32) -> &AtomicU32 {
        assert!(self.inside(off, 1, 4));
        unsafe { &*(self.base.add(off as usize) as *const AtomicU32) }
    }

    pub fn value(&self, off: u32) -> &AtomicU64 {
        assert!(off % 8 == 0 && self.inside(off, 1, 8));
        unsafe { &*(self.base.add(off as usize) as *const AtomicU64) }
    }

    pub fn load(&self, off: u32) -> u32 {
        self.word(off).load(Ordering::Acquire)
    }

    pub fn store(&self, off: u32, to: u32) {
        self.word(off).store(to, Ordering::Release)
    }

    pub fn byte(&self, off: u32) -> u8 {
        (self.load(off & !3) >> (off % 4 * 8)) as u8
    }

    pub fn load_i64(&self, off: u32) -> i64 {
        self.load(off) as i64 | (self.load(off + 4) as i64) << 32
    }
}

impl Drop for Map {
    fn drop(&mut self) {
        unsafe { c::munmap(self.base, self.size as usize) };
    }
}
