// SPDX-License-Identifier: MIT

//! The control socket, and the memory that a controller gets over it.

use crate::calls::*;
use crate::image::*;
use std::fs::File;
use std::io::{Error, Result};
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::atomic::Ordering;

pub struct Welcome {
    pub generation: u32,
    pub start_id: u32,
    pub size: u32,
    pub token: [u8; 16],
    pub files: Vec<File>,
}

pub fn connect(place: &Path, instance: &str, token: &[u8; 16]) -> Result<OwnedFd> {
    let directory = open_place(place)?;
    let path = inside(&directory, instance, "control");
    let mut address = vec![1u8, 0]; // AF_UNIX
    address.extend_from_slice(path.as_bytes());
    address.push(0);
    let fd = unsafe { c::socket(1, c::SOCK_SEQPACKET_NONBLOCK_CLOEXEC, 0) };
    if fd < 0 {
        return Err(Error::last_os_error());
    }
    let socket = unsafe { OwnedFd::from_raw_fd(fd) };
    if unsafe { c::connect(fd, address.as_ptr(), address.len() as u32) } < 0 {
        return Err(Error::last_os_error());
    }
    let mut hello = [0u8; 128];
    hello[0..4].copy_from_slice(&0x4853574fu32.to_le_bytes());
    hello[4] = MAJOR as u8;
    hello[8] = 1; // it wants to command
    hello[16..32].copy_from_slice(token);
    hello[32..42].copy_from_slice(b"controller");
    // An owsd that refuses may have hung up already: its answer can be received all the same
    unsafe { c::send(fd, hello.as_ptr(), hello.len(), c::MSG_NOSIGNAL) };
    Ok(socket)
}

/// The next welcome, waited for so long.
pub fn receive(socket: &OwnedFd, milliseconds: i32) -> Result<Welcome> {
    let (mut data, mut control) = ([0u8; 64], [0usize; 16]);
    let mut part = c::Part { base: data.as_mut_ptr(), len: data.len() };
    let mut message = c::Message {
        name: std::ptr::null_mut(),
        name_len: 0,
        parts: &mut part,
        part_count: 1,
        control: control.as_mut_ptr() as *mut u8,
        control_len: std::mem::size_of_val(&control),
        flags: 0,
    };
    let mut ready = c::Poll { fd: socket.as_raw_fd(), events: 1, revents: 0 };
    if unsafe { c::poll(&mut ready, 1, milliseconds) } < 1 {
        return Err(error(EAGAIN));
    }
    let mut got = -1;
    for _ in 0..2 {
        got = unsafe { c::recvmsg(socket.as_raw_fd(), &mut message, c::MSG_CMSG_CLOEXEC) };
        if got >= 0 || Error::last_os_error().raw_os_error() != Some(ECONNRESET) {
            break;
        }
    }
    if got < 0 {
        return Err(Error::last_os_error());
    }
    // One part of descriptors: its length, level and type, then one i32 for each
    let head = std::mem::size_of::<usize>() + 8;
    let end = if message.control_len < head { head } else { control[0].min(message.control_len) };
    let files = (head..end).step_by(4).map(|at| unsafe {
        let fd = (control.as_ptr() as *const u8).add(at) as *const i32;
        File::from_raw_fd(*fd)
    });
    let word = |at: usize| u32::from_le_bytes(data[at..at + 4].try_into().unwrap());
    let welcome = Welcome {
        generation: word(12),
        start_id: word(16),
        size: word(24),
        token: data[32..48].try_into().unwrap(),
        files: files.collect(),
    };
    match word(8) as i32 {
        _ if got == 0 => Err(error(ECONNRESET)),
        _ if got < 64 || word(0) != 0x5753574f => Err(error(EPROTO)),
        0 if word(4) & 0xffff != MAJOR || welcome.files.is_empty() => Err(error(EPROTO)),
        0 => Ok(welcome),
        refused => Err(error(-refused)),
    }
}

// --- The controller's memory -------------------------------------------------------------------------

pub struct Memory {
    pub map: Map,
    pub slot_off: u32,
    pub slot_size: u32,
    pub text_off: u32,
    pub text_cap: u32,
    pub place_off: u32,
    pub dirty_off: u32,
}

pub const STATE: u32 = 64; // in the header
pub const MARKED: u32 = 128;
pub const BEAT: u32 = 132;
pub const PERIOD_MS: u32 = 136;
pub const GOODBYE: u32 = 140;
pub const STAMP: u32 = 8; // in a slot
pub const TAKEN: u32 = 48;
pub const APPLIED: u32 = 52;
pub const ERR: u32 = 56;
pub const ALLOWED: u32 = 60;

/// Does a slot's `applied` confirm the command `stamp`? One that seems newer than the slot's last
/// command (0: none since a start of owsd) is older than that by 2^31 commands.
pub fn confirms(applied: u32, last: u32, stamp: u32) -> bool {
    let ahead = |of: u32| applied.wrapping_sub(of) as i32;
    ahead(stamp) >= 0 && (last == 0 || ahead(last) <= 0)
}

impl Memory {
    pub fn new(welcome: &Welcome, image: &Image) -> Result<Memory> {
        let file = &welcome.files[0];
        let seals = unsafe { c::fcntl(file.as_raw_fd(), c::F_GET_SEALS) };
        if seals < 0 || seals & 7 != 7 || file.metadata()?.size() != welcome.size as u64 {
            return Err(error(EPROTO));
        }
        let map = Map::new(file, welcome.size as u64, true)?;
        let slots = map.load(32);
        let memory = Memory {
            slot_off: map.load(24),
            slot_size: map.load(28),
            text_off: map.load(36),
            text_cap: map.load(40),
            place_off: map.load(44),
            dirty_off: map.load(48),
            map,
        };
        let map = &memory.map;
        let right = map.load(0) == 0x4753574f
            && map.load(4) & 0xffff == MAJOR
            && map.load(8) == welcome.size
            && (map.load(12), map.load(16)) == (image.generation, image.start_id)
            && slots == image.areas[RECORDS].count
            && memory.slot_size >= 64
            && map.inside(memory.slot_off, slots, memory.slot_size)
            && map.inside(memory.dirty_off, slots.div_ceil(32), 4)
            && map.inside(memory.place_off, slots, 4);
        if right {
            Ok(memory)
        } else {
            Err(error(EPROTO))
        }
    }

    pub fn slot(&self, record: u32) -> u32 {
        self.slot_off + record * self.slot_size
    }

    pub fn live(&self) -> bool {
        self.map.word(STATE).load(Ordering::SeqCst) == LIVE
    }

    pub fn store_text(&self, record: u32, text: &[u8]) -> Result<()> {
        let place = self.map.load(self.place_off + 4 * record);
        let at = self.text_off as u64 + place as u64 * (8 + self.text_cap as u64);
        if text.len() as u32 > self.text_cap || at + 8 + self.text_cap as u64 > self.map.size as u64
        {
            return Err(error(ERANGE));
        }
        let mut check = 0x9e3779b9 ^ text.len() as u32;
        for byte in text {
            check = (check ^ *byte as u32).wrapping_mul(0x85ebca6b);
            check ^= check >> 15;
        }
        self.map.store(at as u32, text.len() as u32);
        for (i, four) in text.chunks(4).enumerate() {
            let mut word = [0u8; 4];
            word[..four.len()].copy_from_slice(four);
            self.map.store(at as u32 + 8 + 4 * i as u32, u32::from_le_bytes(word));
        }
        self.map.store(at as u32 + 4, check);
        Ok(())
    }
}
