// SPDX-License-Identifier: MIT

// Reads the signals of owsd from shared memory without libows, as docs/shared-memory.md describes
// it: for those who write a reader in a language of their own. Columns of a signal: name, type, value,
// quality, age in seconds, err, count of updates, detail (1: simulated).
//
//	go build -o reader reader.go reader_lists.go
//	./reader [-n INSTANCE] [SIGNAL...]            values, once
//	./reader [-n INSTANCE] -f SECONDS             values as they change, over reloads
//	./reader [-n INSTANCE] -l AREA                what else there is: reader_lists.go
package main

import (
	"encoding/binary"
	"errors"
	"flag"
	"fmt"
	"math"
	"os"
	"os/user"
	"path/filepath"
	"sort"
	"strconv"
	"strings"
	"sync/atomic"
	"syscall"
	"time"
	"unsafe"
)

// Kinds of areas, and the least size of an entry of each.
const (
	records = iota + 1
	infos
	names
	targets
	counters
	pool
	texts
	origins
	controllers
	shelves
	alarms
	commands
	changes
	kinds
)

var entrySize = [kinds]uint32{records: 320, infos: 192, names: 8, targets: 128, counters: 64,
	pool: 1, texts: 1, origins: 104, controllers: 120, shelves: 184, alarms: 200, commands: 200, changes: 8}

const (
	imageMagic, headerSize            = 0x4953574f, 256
	live, retired, stopped            = 1, 2, 3      // states
	stateOff, newsOff, changeHeadOff  = 16, 128, 140 // in the header
	alarmHeadOff, commandHeadOff      = 132, 136     // likewise
	qualityNoOwsd, qualityStale       = 0x1a, 0x14   // what a reader lowers a quality to
	typeFloat, typeDouble, typeString = 7, 8, 12     // types whose values are read in another way
	tries                             = 64           // rounds, before a copy is given up
	deadNs                            = int64(2e9)   // least age of a dead heartbeat
	clockBoottime, futexWait          = 7, 0         // of Linux
)

var typeNames = map[byte]string{1: "bool", 2: "byte", 3: "short", 4: "long", 5: "word", 6: "dword",
	7: "float", 8: "double", 10: "large", 12: "string"}

type area struct{ off, size, count uint32 }

// A mapped image.
type image struct {
	memory            []byte
	path              string
	device, inode     uint64
	areas             [kinds]area
	startNs, periodNs int64
	lookedNs          int64
	orphan            bool
}

func bootTime() int64 {
	var t syscall.Timespec
	syscall.Syscall(syscall.SYS_CLOCK_GETTIME, clockBoottime, uintptr(unsafe.Pointer(&t)), 0)
	return t.Nano()
}

// --- Opening ------------------------------------------------------------------------------------

func isOwsd(uid int) bool {
	owsd, err := user.Lookup("owsd")
	return err == nil && owsd.Uid == strconv.Itoa(uid)
}

func trusted(uid uint32) bool {
	return uid == 0 || int(uid) == os.Geteuid() || isOwsd(int(uid))
}

func places() []string {
	own := "/dev/shm/owsd-" + strconv.Itoa(os.Geteuid())
	if runtime := os.Getenv("XDG_RUNTIME_DIR"); runtime != "" {
		own = filepath.Join(runtime, "owsd")
	}
	if named := os.Getenv("OWS_DIR"); named != "" {
		return []string{named}
	} else if os.Geteuid() == 0 || isOwsd(os.Geteuid()) {
		return []string{"/run/owsd"}
	}
	return []string{own, "/run/owsd"}
}

// The place is a directory of a trusted owner, and nobody else may write into it.
func openPlace(place string) (int, error) {
	fd, err := syscall.Open(place,
		syscall.O_RDONLY|syscall.O_DIRECTORY|syscall.O_NOFOLLOW|syscall.O_CLOEXEC, 0)
	if err != nil {
		return -1, err
	}
	var st syscall.Stat_t
	if syscall.Fstat(fd, &st) != nil || !trusted(st.Uid) || st.Mode&0o022 != 0 {
		syscall.Close(fd)
		return -1, errors.New(place + ": others may write into it, or it is another user's")
	}
	return fd, nil
}

func openImage(place, instance string) (*image, error) {
	folder, err := openPlace(place)
	if err != nil {
		return nil, err
	}
	defer syscall.Close(folder)
	fd, err := syscall.Openat(folder, instance+".image",
		syscall.O_RDONLY|syscall.O_NOFOLLOW|syscall.O_CLOEXEC|syscall.O_NONBLOCK, 0)
	if err != nil {
		return nil, err
	}
	defer syscall.Close(fd)
	var st syscall.Stat_t
	if err := syscall.Fstat(fd, &st); err != nil {
		return nil, err
	}
	if st.Mode&syscall.S_IFMT != syscall.S_IFREG || !trusted(st.Uid) {
		return nil, syscall.EPERM
	}
	if st.Size < headerSize || st.Size > math.MaxInt32 {
		return nil, syscall.EPROTO
	}
	memory, err := syscall.Mmap(fd, 0, int(st.Size), syscall.PROT_READ, syscall.MAP_SHARED)
	if err != nil {
		return nil, err
	}
	m := &image{memory: memory, path: filepath.Join(place, instance+".image"),
		device: uint64(st.Dev), inode: st.Ino}
	if !m.check() {
		syscall.Munmap(memory)
		return nil, syscall.EPROTO
	}
	return m, nil
}

// The first living image in these places, else the first at all.
func find(where []string, instance string) (*image, error) {
	var first *image
	var reason error
	for _, place := range where {
		m, err := openImage(place, instance)
		if err != nil {
			if reason == nil || errors.Is(reason, syscall.ENOENT) {
				reason = err
			}
			continue
		}
		if first == nil || m.lives(bootTime()) {
			first, m = m, first
		}
		if m != nil {
			syscall.Munmap(m.memory)
		}
		if first.lives(bootTime()) {
			break
		}
	}
	if first == nil {
		return nil, reason
	}
	return first, nil
}

func (m *image) inside(off, count, size uint32) bool {
	return off%8 == 0 && uint64(off)+uint64(count)*uint64(size) <= uint64(len(m.memory))
}

func (m *image) check() bool {
	h := m.memory
	if u32(h, 0) != imageMagic || binary.LittleEndian.Uint16(h[4:]) != 2 ||
		uint64(u32(h, 8)) != uint64(len(h)) {
		return false
	}
	off, count := u32(h, 28), u32(h, 32)
	if !m.inside(off, count, 16) {
		return false
	}
	for i := uint32(0); i < count; i++ {
		e := h[off+16*i:]
		kind, a := u32(e, 0), area{u32(e, 4), u32(e, 8), u32(e, 12)}
		if kind == 0 || kind >= kinds || a.count == 0 {
			continue
		}
		least := entrySize[kind]
		if m.areas[kind].count != 0 || a.size < least || least > 1 && a.size%8 != 0 ||
			least == 1 && a.size != 1 || !m.inside(a.off, a.count, a.size) {
			return false
		}
		m.areas[kind] = a
	}
	n, strings := m.areas[records].count, m.areas[pool]
	m.startNs, m.periodNs = i64(h, 40), i64(h, 56)
	return n != 0 && m.areas[infos].count == n && m.areas[names].count == n &&
		strings.count != 0 && h[strings.off+strings.count-1] == 0
}

// --- Reading ------------------------------------------------------------------------------------

func u32(b []byte, off uint32) uint32  { return binary.LittleEndian.Uint32(b[off:]) }
func i64(b []byte, off uint32) int64   { return int64(binary.LittleEndian.Uint64(b[off:])) }
func f64(b []byte, off uint32) float64 { return math.Float64frombits(uint64(i64(b, off))) }

// A word that owsd may be writing. Go's atomic loads are sequentially consistent: no fence needed.
func (m *image) word(off uint32) uint32 {
	return atomic.LoadUint32((*uint32)(unsafe.Pointer(&m.memory[off])))
}

func (m *image) words(off, bytes uint32) []byte {
	to := make([]byte, (bytes+3)/4*4)
	for i := uint32(0); i < bytes; i += 4 {
		binary.LittleEndian.PutUint32(to[i:], m.word(off+i))
	}
	return to[:bytes]
}

func (m *image) at(kind int, i uint32) uint32 { return m.areas[kind].off + i*m.areas[kind].size }

func (m *image) info(record uint32) []byte {
	at := m.at(infos, record)
	return m.memory[at : at+entrySize[infos]]
}

// A string of the pool, which ends with a NUL.
func (m *image) text(off uint32) string {
	p := m.areas[pool]
	if off < p.off || off-p.off >= p.count {
		return ""
	}
	return cut(m.memory[off : p.off+p.count])
}

func cut(text []byte) string {
	for i, b := range text {
		if b == 0 {
			return string(text[:i])
		}
	}
	return string(text)
}

// A whole slot of a record; of a string signal its text too.
func (m *image) slot(record uint32) (slot, text []byte, ok bool) {
	at, t := m.at(records, record), m.areas[texts]
	textOff, textCap := u32(m.memory, at+4), uint32(binary.LittleEndian.Uint16(m.memory[at+10:]))
	if textCap != 0 && (textOff%4 != 0 || textOff < t.off ||
		uint64(textOff)+2*uint64(textCap) > uint64(t.off)+uint64(t.count)) {
		return nil, nil, false
	}
	for i := 0; i < tries; i++ {
		seq := m.word(at)
		half := seq >> 1 & 1
		slot = m.words(at+16+128*half, 128)
		text = m.words(textOff+half*textCap, min(u32(slot, 40), textCap))
		if m.word(at)-(seq&^1) <= 2 {
			return slot, text, true
		}
	}
	return nil, nil, false
}

// An entry that changes as a whole; false: it was never written, or owsd died in it.
func (m *image) entry(kind int, i uint32) ([]byte, bool) {
	at := m.at(kind, i)
	for try := 0; try < tries; try++ {
		seq := m.word(at)
		e := m.words(at, entrySize[kind])
		if seq%2 == 0 && m.word(at) == seq {
			return e, seq != 0
		}
	}
	return nil, false
}

func (m *image) state() uint32 { return m.word(stateOff) }

// Does owsd's heart beat?
func (m *image) beats(now int64) bool {
	slot, _, ok := m.slot(0)
	dead := max(deadNs, 3*m.periodNs)
	return ok && now-i64(slot, 8) <= dead && i64(slot, 8)-now <= dead
}

func (m *image) lives(now int64) bool { return m.state() == live && m.beats(now) }

// Is another image due? Looks at the file's name once a second, while the heart stands still.
func (m *image) stale(now int64) bool {
	if m.state() != live {
		return true
	}
	if m.beats(now) {
		return false
	}
	if now-m.lookedNs >= 1e9 {
		var st syscall.Stat_t
		m.lookedNs = now
		m.orphan = syscall.Lstat(m.path, &st) == nil &&
			(uint64(st.Dev) != m.device || st.Ino != m.inode)
	}
	return m.orphan
}

// The record of a signal's name; 0: there is none.
func (m *image) find(name string) uint32 {
	i, found := sort.Find(int(m.areas[names].count), func(i int) int {
		return strings.Compare(name, m.text(u32(m.memory, m.at(names, uint32(i)))))
	})
	if !found {
		return 0
	}
	return u32(m.memory, m.at(names, uint32(i))+4)
}

// --- Printing -----------------------------------------------------------------------------------

func (m *image) kind(record uint32) byte { return m.memory[m.at(records, record)+8] }

// A value as text, of 8 bytes at an offset.
func (m *image) value(record uint32, b []byte, off uint32) string {
	switch m.kind(record) {
	case typeFloat:
		return strconv.FormatFloat(f64(b, off), 'g', -1, 32)
	case typeDouble:
		return strconv.FormatFloat(f64(b, off), 'g', -1, 64)
	}
	return strconv.FormatInt(i64(b, off), 10)
}

// "" for a record that is none.
func (m *image) name(record uint32) string {
	if record >= m.areas[records].count {
		return ""
	}
	return m.text(u32(m.info(record), 0))
}

// What is read of a signal. The value is to be used only where quality&0xc0 is 0xc0.
type reading struct {
	kind, value string
	quality     byte
	age         time.Duration
	err         int32
	count       uint32
	detail      byte // 1: simulated
}

// By name, for a program of one's own; false: there is no such signal, or owsd died in it.
func (m *image) get(name string) (reading, bool) {
	record := m.find(name)
	if m.name(record) == "" {
		return reading{}, false
	}
	return m.read(record, bootTime())
}

func (m *image) read(record uint32, now int64) (reading, bool) {
	slot, text, ok := m.slot(record)
	if !ok {
		return reading{}, false
	}
	value, quality, since := m.value(record, slot, 0), slot[28], i64(slot, 8)
	if m.kind(record) == typeString {
		value = string(text)
	}
	if since == 0 {
		since = m.startNs
	}
	age := max(0, now-since)
	staleAfter, state := i64(m.info(record), 16), m.state()
	if quality&0xc0 == 0xc0 {
		if state != live && state != retired || !m.beats(now) ||
			since-now > max(deadNs, 3*m.periodNs) {
			quality = qualityNoOwsd
		} else if staleAfter != 0 && age > staleAfter {
			quality = qualityStale
		}
	}
	return reading{typeNames[m.kind(record)], value, quality, time.Duration(age),
		int32(u32(slot, 24)), u32(slot, 32), slot[29]}, true
}

func (r reading) print(name string) {
	fmt.Printf("%s\t%s\t%s\t0x%02x\t%.3f\t%d\t%d\t%d\n", name, r.kind, r.value, r.quality,
		r.age.Seconds(), r.err, r.count, r.detail)
}

func (m *image) printSignal(record uint32, now int64) {
	if r, ok := m.read(record, now); ok {
		r.print(m.name(record))
	} else {
		fmt.Printf("%s\tnot whole\n", m.name(record))
	}
}

func (m *image) printAll() {
	now := bootTime()
	for record := uint32(1); record < m.areas[records].count; record++ {
		m.printSignal(record, now)
	}
}

// --- Following ----------------------------------------------------------------------------------

// The records that changed since number from, each once, and the number to go on with; all: the
// reader fell behind.
func (m *image) changed(from uint32) (list []uint32, next uint32, all bool) {
	ring := m.areas[changes].count
	head := m.word(changeHeadOff)
	if ring == 0 || head-from > ring-1 {
		return nil, head, true
	}
	seen := map[uint32]bool{}
	for n := from; n != head; n++ {
		record := m.word(m.at(changes, n%ring) + 4)
		if m.name(record) != "" && !seen[record] {
			seen[record] = true
			list = append(list, record)
		}
	}
	return list, head, m.word(changeHeadOff)-from > ring-1
}

// Sleeps until something is published, a second at most.
func (m *image) wait(news uint32) {
	timeout := syscall.NsecToTimespec(1e9)
	syscall.Syscall6(syscall.SYS_FUTEX, uintptr(unsafe.Pointer(&m.memory[newsOff])), futexWait,
		uintptr(news), uintptr(unsafe.Pointer(&timeout)), 0, 0)
}

// The present image, if there is another one by now and it is live.
func (m *image) next(where []string, instance string) *image {
	other, err := find(where, instance)
	if err != nil {
		return m
	}
	if other.state() != live || other.device == m.device && other.inode == m.inode {
		syscall.Munmap(other.memory)
		return m
	}
	syscall.Munmap(m.memory)
	fmt.Println("# another image")
	return other
}

func follow(m *image, instance string, until time.Time) {
	next, all, alive := uint32(0), true, false
	where := places() // until it meets a living owsd; then it stays there
	for time.Now().Before(until) {
		news, now := m.word(newsOff), bootTime()
		if m.lives(now) {
			where = []string{filepath.Dir(m.path)}
		} else if m.stale(now) || len(where) > 1 {
			if other := m.next(where, instance); other != m {
				m, all = other, true
				continue
			}
		}
		list := []uint32{}
		if all {
			next = m.word(changeHeadOff)
		} else {
			list, next, all = m.changed(next)
		}
		// What a dead owsd leaves turns bad by itself
		if beats := m.lives(now); beats != alive {
			alive, all = beats, true
			fmt.Println(map[bool]string{true: "# owsd lives", false: "# owsd is dead"}[alive])
		}
		if all {
			m.printAll()
		}
		for _, record := range list {
			m.printSignal(record, now)
		}
		all = false
		m.wait(news)
		if m.state() == stopped {
			time.Sleep(time.Second / 10) // its news count no more
		}
	}
}

func main() {
	instance := flag.String("n", "OWS", "the instance")
	seconds := flag.Float64("f", 0, "follow the changes for so many seconds")
	what := flag.String("l", "", "list another area")
	flag.Parse()
	m, err := find(places(), *instance)
	if err != nil {
		fmt.Fprintln(os.Stderr, "cannot open owsd's image:", err)
		os.Exit(1)
	}
	switch {
	case *seconds > 0:
		follow(m, *instance, time.Now().Add(time.Duration(*seconds*1e9)))
	case *what != "":
		if !m.list(*what) {
			flag.Usage()
			os.Exit(2)
		}
	case flag.NArg() == 0:
		m.printAll()
	}
	for _, name := range flag.Args() {
		r, ok := m.get(name)
		if !ok {
			fmt.Fprintln(os.Stderr, "no signal", name)
			os.Exit(1)
		}
		r.print(name)
	}
}
