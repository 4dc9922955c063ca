// SPDX-License-Identifier: MIT

//! Where owsd's files are, and its image: what a program needs of it that commands.

use crate::calls::*;
use std::fs::{self, File, OpenOptions};
use std::io::Result;
use std::os::fd::AsRawFd;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::sync::atomic::{fence, Ordering};

const DEAD_NS: i64 = 2_000_000_000; // least age of a dead heartbeat
const TRIES: u32 = 64; // rounds, before a copy is given up
pub const MAJOR: u32 = 2;
pub const LIVE: u32 = 1; // a state
pub const RECORDS: usize = 1; // kinds of areas
const INFOS: usize = 2;
const NAMES: usize = 3;
const POOL: usize = 6;

pub fn uid_of_owsd() -> Option<u32> {
    let users = fs::read_to_string("/etc/passwd").ok()?;
    let line = users.lines().find(|line| line.starts_with("owsd:"))?;
    line.split(':').nth(2)?.parse().ok()
}

pub fn trusted(uid: u32) -> bool {
    uid == 0 || uid == unsafe { c::geteuid() } || Some(uid) == uid_of_owsd()
}

pub fn places() -> Vec<PathBuf> {
    let uid = unsafe { c::geteuid() };
    if let Some(named) = std::env::var_os("OWS_DIR") {
        return vec![PathBuf::from(named)];
    } else if uid == 0 || Some(uid) == uid_of_owsd() {
        return vec![PathBuf::from("/run/owsd")];
    }
    let own = match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(runtime) => Path::new(&runtime).join("owsd"),
        None => PathBuf::from(format!("/dev/shm/owsd-{uid}")),
    };
    vec![own, PathBuf::from("/run/owsd")]
}

/// Opens without following a link, and checks the owner.
pub fn open_trusted(path: &Path, flags: i32) -> Result<File> {
    let file =
        OpenOptions::new().read(true).custom_flags(c::O_DIRECTORY_NOFOLLOW.1 | flags).open(path)?;
    let about = file.metadata()?;
    let open_to_others = about.is_dir() && about.mode() & 0o022 != 0;
    if !trusted(about.uid()) || open_to_others || !(about.is_dir() || about.is_file()) {
        return Err(error(EPERM));
    }
    Ok(file)
}

pub fn open_place(place: &Path) -> Result<File> {
    open_trusted(place, c::O_DIRECTORY_NOFOLLOW.0)
}

/// The path of a file in an open place.
pub fn inside(place: &File, instance: &str, kind: &str) -> String {
    format!("/proc/self/fd/{}/{instance}.{kind}", place.as_raw_fd())
}

#[derive(Clone, Copy, Default)]
pub struct Area {
    pub off: u32,
    pub size: u32,
    pub count: u32,
}

pub struct Image {
    pub map: Map,
    pub areas: [Area; 14],
    pub file: (u64, u64),
    pub generation: u32,
    pub start_id: u32,
    pub start_ns: i64,
    pub dead_ns: i64,
}

impl Image {
    pub fn open(place: &Path, instance: &str) -> Result<Image> {
        let directory = open_place(place)?;
        let file = open_trusted(Path::new(&inside(&directory, instance, "image")), 0)?;
        let about = file.metadata()?;
        let map = Map::new(&file, about.size(), false)?;
        let mut image = Image {
            generation: map.load(12),
            start_id: map.load(24),
            start_ns: map.load_i64(40),
            dead_ns: DEAD_NS.max(map.load_i64(56).saturating_mul(3)),
            file: (about.dev(), about.ino()),
            areas: Default::default(),
            map,
        };
        if image.check() {
            Ok(image)
        } else {
            Err(error(EPROTO))
        }
    }

    pub fn check(&mut self) -> bool {
        const LEAST: [u32; 14] = [0, 320, 192, 8, 128, 64, 1, 1, 104, 120, 184, 200, 200, 8];
        let (map, off, count) = (&self.map, self.map.load(28), self.map.load(32));
        if map.load(0) != 0x4953574f || map.load(4) & 0xffff != MAJOR || map.load(8) != map.size {
            return false;
        }
        if !map.inside(off, count, 16) {
            return false;
        }
        for entry in (0..count).map(|i| off + 16 * i) {
            let kind = map.load(entry) as usize;
            let area = Area {
                off: map.load(entry + 4),
                size: map.load(entry + 8),
                count: map.load(entry + 12),
            };
            if kind == 0 || kind >= LEAST.len() || area.count == 0 {
                continue;
            }
            let fits = if LEAST[kind] == 1 {
                area.size == 1
            } else {
                area.size >= LEAST[kind] && area.size % 8 == 0
            };
            if self.areas[kind].count != 0
                || !fits
                || area.off % 8 != 0
                || !map.inside(area.off, area.count, area.size)
            {
                return false;
            }
            self.areas[kind] = area;
        }
        let records = self.areas[RECORDS].count;
        records != 0
            && self.areas[INFOS].count == records
            && self.areas[NAMES].count == records
            && self.areas[POOL].count != 0
    }

    pub fn at(&self, kind: usize, i: u32) -> u32 {
        self.areas[kind].off + i * self.areas[kind].size
    }

    pub fn state(&self) -> u32 {
        self.map.load(16)
    }

    /// A word of the present slot of a record and the one after it, of one state.
    pub fn two_words(&self, record: u32, off: u32) -> Option<(u32, u32)> {
        let at = self.at(RECORDS, record);
        for _ in 0..TRIES {
            let seq = self.map.load(at);
            let slot = at + 16 + 128 * (seq >> 1 & 1);
            let two = (self.map.load(slot + off), self.map.load(slot + off + 4));
            fence(Ordering::Acquire);
            if self.map.load(at).wrapping_sub(seq & !1) <= 2 {
                return Some(two);
            }
        }
        None
    }

    /// Does owsd live, and is this its image?
    pub fn lives(&self) -> bool {
        let Some((low, high)) = self.two_words(0, 8) else { return false };
        let age = now_ns() - (low as i64 | (high as i64) << 32);
        self.state() == LIVE && age.abs() <= self.dead_ns
    }

    /// Does the name lead to another file?
    pub fn is_elsewhere(&self, place: &Path, instance: &str) -> bool {
        let there = fs::symlink_metadata(place.join(format!("{instance}.image")));
        there.is_ok_and(|there| (there.dev(), there.ino()) != self.file)
    }

    pub fn text(&self, off: u32) -> Vec<u8> {
        let pool = self.areas[POOL];
        let rest = if off < pool.off { 0..0 } else { off..pool.off + pool.count };
        rest.map(|at| self.map.byte(at)).take_while(|byte| *byte != 0).collect()
    }

    /// The record of a signal's name.
    pub fn find(&self, name: &str) -> Result<u32> {
        (1..self.areas[RECORDS].count)
            .find(|record| self.text(self.map.load(self.at(INFOS, *record))) == name.as_bytes())
            .ok_or(error(ENOENT))
    }

    pub fn kind(&self, record: u32) -> u8 {
        self.map.byte(self.at(RECORDS, record) + 8)
    }

    /// Does the signal take sets? 0 or the error.
    pub fn takes_sets(&self, record: u32) -> i32 {
        let flags = self.map.byte(self.at(RECORDS, record) + 9);
        let enabled = self.two_words(record, 48 + 64).is_some_and(|(flags, _)| flags & 2 != 0);
        match (flags & 1 != 0, flags & 8 != 0) {
            (_, true) => EROFS,
            (false, _) if !enabled => EACCES,
            _ => 0,
        }
    }
}
