// SPDX-License-Identifier: MIT

// Lists what the image of owsd has beside the values: a part of reader.go.
package main

import "fmt"

func who(b []byte, off uint32) string {
	return fmt.Sprintf("%d\t%d\t%d\t%s\t%s", u32(b, off), u32(b, off+4), int32(u32(b, off+8)),
		cut(b[off+16:off+48]), cut(b[off+48:off+80]))
}

func (m *image) printInfo(record uint32) {
	b := m.info(record)
	fmt.Printf("%s\t%d", m.name(record), u32(b, 12))
	for _, off := range []uint32{4, 44, 48, 52, 56, 60, 64} { // path, unit ... points
		fmt.Printf("\t%s", m.text(u32(b, off)))
	}
	fmt.Printf("\t%d", int32(u32(b, 68)))         // decimals
	for off := uint32(72); off <= 144; off += 8 { // scale ... deadband
		fmt.Printf("\t%g", f64(b, off))
	}
	fmt.Println()
}

func (m *image) printJournal(kind int, head uint32) {
	ring := m.areas[kind].count
	for n := head - min(head, ring); n != head; n++ {
		e, ok := m.entry(kind, n%ring)
		record := uint32(0)
		if ok {
			record = u32(e, 4)
		}
		if m.name(record) == "" || u32(e, 184) != n {
			continue
		}
		before, after := "-", "-"
		if e[35]&1 != 0 {
			before = m.value(record, e, 16)
		}
		if e[35]&2 != 0 {
			after = m.value(record, e, 24)
		}
		fmt.Printf("%d\t%s\t%d\t%d\t%d\t%s\t%s\t0x%02x\t%d\t%s\t%s\n", n, m.name(record), i64(e, 8),
			e[32], e[33], before, after, e[34], u32(e, 36), cut(e[40:104]), who(e, 104))
	}
}

// The entries that are in use: of origins, controllers and shelves the word behind seq says so.
func (m *image) each(kind int, print func(i uint32, e []byte)) {
	for i := uint32(0); i < m.areas[kind].count; i++ {
		if e, ok := m.entry(kind, i); ok && u32(e, 4) != 0 {
			print(i, e)
		}
	}
}

func (m *image) list(what string) bool {
	switch what {
	case "info":
		for i := uint32(1); i < m.areas[records].count; i++ {
			m.printInfo(i)
		}
	case "alarms":
		m.printJournal(alarms, m.word(alarmHeadOff))
	case "commands":
		m.printJournal(commands, m.word(commandHeadOff))
	case "controllers":
		m.each(controllers, func(i uint32, e []byte) {
			fmt.Println(i, u32(e, 4), u32(e, 96), u32(e, 100), u32(e, 104), who(e, 16))
		})
	case "origins":
		m.each(origins, func(i uint32, e []byte) {
			fmt.Println(m.name(i), u32(e, 4), i64(e, 8), who(e, 16))
		})
	case "shelves":
		m.each(shelves, func(_ uint32, e []byte) {
			fmt.Println(m.name(u32(e, 4)), i64(e, 8), i64(e, 16), cut(e[104:168]), who(e, 24))
		})
	case "targets":
		for i := uint32(0); i < m.areas[targets].count; i++ {
			at := m.at(targets, i)
			fmt.Printf("%s\t%d\t%d\t%d\t%d\n", cut(m.memory[at:at+104]), m.word(at+104),
				m.word(at+108), m.word(at+112), m.word(at+116))
		}
	case "counters":
		for i := uint32(0); i < m.areas[counters].count; i++ {
			at := m.at(counters, i)
			fmt.Printf("%s\t%d\t%d\n", cut(m.memory[at:at+48]), int32(u32(m.memory, at+48)),
				uint64(m.word(at+60))<<32|uint64(m.word(at+56)))
		}
	default:
		return false
	}
	return true
}
