// SPDX-License-Identifier: MIT

//! Commands outputs of owsd without libows, as docs/shared-memory.md describes it: for those who
//! write a control program in a language of their own.
//!
//!     rustc --edition 2021 -O controller.rs       # the others belong to it
//!     ./controller [INSTANCE [MILLISECONDS]]
//!
//! It takes lines from its standard input: NAME=VALUE sets a signal, and "quit" or the end of the
//! input says goodbye. It beats and promises to beat again within MILLISECONDS (1000), follows owsd
//! over reloads and restarts, and prints what becomes of its commands.

#[path = "controller_calls.rs"]
mod calls;
#[path = "controller_image.rs"]
mod image;
#[path = "controller_memory.rs"]
mod memory;

use calls::*;
use image::*;
use memory::*;
use std::fs::File;
use std::io::{self, BufRead, Result};
use std::os::fd::{AsRawFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::atomic::{fence, Ordering};
use std::sync::mpsc::{self, TryRecvError};
use std::time::Duration;

const CYCLE: Duration = Duration::from_millis(20);
const LOST_NS: i64 = 2_000_000_000; // a welcome that is not here by then never comes

// --- The controller ----------------------------------------------------------------------------------

struct Controller {
    place: PathBuf,
    instance: String,
    image: Image,
    socket: OwnedFd,
    bell: File,
    token: [u8; 16],
    memory: Memory,
    newest: Option<Welcome>, // the last that came after the first
    awaited_ns: i64,         // since when it waits for the one of a reload; 0: it does not
    stamp: u32,
    period_ms: u32,
    looked_ns: i64,
}

/// Connects, and gets the memory of the image that is there.
fn join(
    place: &Path,
    instance: &str,
    token: &[u8; 16],
) -> Result<(Image, OwnedFd, Welcome, Memory)> {
    let socket = connect(place, instance, token)?;
    let welcome = receive(&socket, 2000)?;
    let image = Image::open(place, instance)?;
    if welcome.files.len() != 3 {
        return Err(error(EPROTO));
    }
    // A reload meanwhile: the next try finds both of one generation
    let memory = Memory::new(&welcome, &image)?;
    Ok((image, socket, welcome, memory))
}

impl Controller {
    fn open(instance: &str, period_ms: u32) -> Result<Controller> {
        let mut reason = error(ENOENT);
        for place in places() {
            match join(&place, instance, &[0; 16]) {
                Ok((image, socket, mut welcome, memory)) => {
                    let controller = Controller {
                        place,
                        instance: instance.to_string(),
                        image,
                        socket,
                        bell: welcome.files.remove(1),
                        token: welcome.token,
                        memory,
                        newest: None,
                        awaited_ns: 0,
                        stamp: 0,
                        period_ms,
                        looked_ns: 0,
                    };
                    controller.promise();
                    return Ok(controller);
                }
                Err(e) => reason = e,
            }
        }
        Err(reason)
    }

    /// Is there another image, or a memory that nobody looks at?
    fn is_stale(&mut self) -> bool {
        if self.image.state() != LIVE || !self.memory.live() {
            return true;
        }
        if self.image.lives() || now_ns() - self.looked_ns < 1_000_000_000 {
            return false;
        }
        self.looked_ns = now_ns();
        self.image.is_elsewhere(&self.place, &self.instance)
    }

    /// Goes on with the present image. Says whether it is one of another start.
    fn reopen(&mut self) -> Result<bool> {
        let image = Image::open(&self.place, &self.instance)?;
        if image.state() != LIVE {
            return Err(error(ENOENT));
        }
        if image.start_ns != self.image.start_ns {
            return self.join_again();
        }
        loop {
            match receive(&self.socket, if self.newest.is_none() { 20 } else { 0 }) {
                Ok(welcome) => self.newest = Some(welcome),
                Err(e) if e.raw_os_error() == Some(EAGAIN) => break,
                Err(_) => return self.join_again(),
            }
        }
        // It may be of an image that is not there yet, and is kept for the next try
        let present = (image.generation, image.start_id);
        match &self.newest {
            Some(welcome) if (welcome.generation, welcome.start_id) == present => {
                self.memory = Memory::new(welcome, &image)?;
            }
            _ => return self.wait(),
        }
        (self.image, self.newest, self.awaited_ns) = (image, None, 0);
        self.promise();
        Ok(false)
    }

    /// A welcome takes milliseconds. One is lost if owsd-porter is killed that moment.
    fn wait(&mut self) -> Result<bool> {
        if self.awaited_ns == 0 {
            self.awaited_ns = now_ns();
        }
        if now_ns() - self.awaited_ns < LOST_NS {
            return Err(error(EAGAIN));
        }
        self.join_again()
    }

    fn join_again(&mut self) -> Result<bool> {
        let (image, socket, mut welcome, memory) = join(&self.place, &self.instance, &self.token)?;
        let restarted = image.start_ns != self.image.start_ns;
        (self.image, self.socket, self.memory) = (image, socket, memory);
        (self.newest, self.awaited_ns) = (None, 0);
        self.bell = welcome.files.remove(1);
        self.token = welcome.token;
        self.promise();
        Ok(restarted)
    }

    fn ring(&self) -> Result<()> {
        let map = &self.memory.map;
        map.store(MARKED, 1);
        fence(Ordering::SeqCst);
        if self.image.map.load(192) == 0 {
            let one = 1u64.to_ne_bytes(); // a full bell has rung already
            unsafe { c::write(self.bell.as_raw_fd(), one.as_ptr(), 8) };
        }
        if self.memory.live() {
            Ok(())
        } else {
            Err(error(ESTALE))
        }
    }

    fn beat(&self) {
        self.memory.map.word(BEAT).fetch_add(1, Ordering::Release);
    }

    fn promise(&self) {
        self.memory.map.store(PERIOD_MS, self.period_ms);
        self.beat();
        let _ = self.ring(); // a memory that was retired meanwhile is noticed in the next cycle
    }

    fn set(&mut self, name: &str, text: &str) -> Result<u32> {
        let record = self.image.find(name)?;
        let slot = self.memory.slot(record);
        if !self.memory.live() || !self.image.lives() {
            return Err(error(ESTALE));
        }
        let refused = self.image.takes_sets(record);
        if refused != 0 || self.memory.map.load(slot + ALLOWED) == 0 {
            return Err(error(if refused != 0 { refused } else { EACCES }));
        }
        if self.image.kind(record) == 12 {
            self.memory.store_text(record, text.as_bytes())?;
        } else {
            let value = encode(self.image.kind(record), text)?;
            self.memory.map.value(slot).store(value, Ordering::Relaxed);
        }
        self.stamp = self.stamp.wrapping_add(1).max(1);
        self.memory.map.store(slot + STAMP, self.stamp);
        let mark = self.memory.map.word(self.memory.dirty_off + record / 32 * 4);
        mark.fetch_or(1 << (record % 32), Ordering::Release);
        self.ring().map(|_| self.stamp)
    }

    /// What has become of the command with that stamp?
    fn fate(&self, name: &str, stamp: u32) -> String {
        let Ok(record) = self.image.find(name) else { return "gone".to_string() };
        let slot = self.memory.slot(record);
        let (map, taken) = (&self.memory.map, self.memory.map.load(slot + TAKEN));
        let (applied, last) = (map.load(slot + APPLIED), map.load(slot + STAMP));
        match map.load(slot + ERR) as i32 {
            _ if taken != stamp => "not taken".to_string(),
            0 if confirms(applied, last, stamp) => "applied".to_string(),
            0 => "taken".to_string(),
            err => format!("refused: {}", error(-err)),
        }
    }

    fn goodbye(self) {
        self.memory.map.store(GOODBYE, 1);
    }
}

/// The bits of a value; ERANGE: the type cannot hold it.
fn encode(kind: u8, text: &str) -> Result<u64> {
    if kind == 7 || kind == 8 {
        let value: f64 = text.parse().map_err(|_| error(EINVAL))?;
        let fits = value.is_finite() && (kind == 8 || (value as f32).is_finite());
        return if fits { Ok(value.to_bits()) } else { Err(error(ERANGE)) };
    }
    let value: i64 = text.parse().map_err(|_| error(EINVAL))?;
    let range = match kind {
        1 => 0..=1,
        2 => 0..=255,
        3 => i16::MIN as i64..=i16::MAX as i64,
        4 => i32::MIN as i64..=i32::MAX as i64,
        5 => 0..=u16::MAX as i64,
        6 => 0..=u32::MAX as i64,
        _ => i64::MIN..=i64::MAX,
    };
    if range.contains(&value) {
        Ok(value as u64)
    } else {
        Err(error(ERANGE))
    }
}

// --- The program --------------------------------------------------------------------------------

/// The last command for a signal.
struct Command {
    name: String,
    text: String,
    stamp: u32,
    told: String,
}

fn take_line(controller: &mut Controller, commands: &mut Vec<Command>, line: &str) {
    let Some((name, text)) = line.split_once('=') else {
        println!("{line}: no NAME=VALUE");
        return;
    };
    match controller.set(name, text) {
        Ok(stamp) => {
            commands.retain(|command| command.name != name);
            let (name, text) = (name.to_string(), text.to_string());
            commands.push(Command { name, text, stamp, told: String::new() });
        }
        Err(e) => println!("{line}: {e}"),
    }
}

fn tell(controller: &Controller, commands: &mut [Command]) {
    for command in commands {
        let fate = controller.fate(&command.name, command.stamp);
        if fate != command.told {
            println!("{}={}: {fate}", command.name, command.text);
            command.told = fate;
        }
    }
}

fn follow(controller: &mut Controller, commands: &mut [Command], away: &mut bool) {
    if !controller.is_stale() {
        return;
    }
    match controller.reopen() {
        Ok(restarted) => {
            println!("# {}", if restarted { "another owsd" } else { "reloaded" });
            commands.iter_mut().for_each(|command| command.told.clear());
            *away = false;
        }
        Err(_) if *away => (),
        Err(e) => {
            println!("# away: {e}");
            *away = true;
        }
    }
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let instance = arguments.get(1).map_or("OWS", String::as_str);
    let period_ms = arguments.get(2).map_or(1000, |text| text.parse().expect("milliseconds"));
    let mut controller = Controller::open(instance, period_ms)?;
    println!("# connected");
    let (to, from) = mpsc::channel();
    std::thread::spawn(move || {
        io::stdin().lock().lines().try_for_each(|line| to.send(line.unwrap_or_default()))
    });
    let (mut commands, mut away) = (Vec::new(), false);
    loop {
        follow(&mut controller, &mut commands, &mut away);
        controller.beat();
        match from.try_recv() {
            Ok(line) if line == "quit" => break,
            Ok(line) => take_line(&mut controller, &mut commands, &line),
            Err(TryRecvError::Empty) => (),
            Err(TryRecvError::Disconnected) => break,
        }
        if !away {
            tell(&controller, &mut commands);
        }
        std::thread::sleep(CYCLE);
    }
    controller.goodbye();
    println!("# goodbye");
    Ok(())
}
