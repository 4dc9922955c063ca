# SPDX-License-Identifier: MIT
# owsd: the makefile is the map of the program. Everything is built in $(B).
#
#   make                          owsd, owsctl, the other programs and libows, in build/
#   make help                     these lines
#   make run                      the main job, on a simulated house; no root, nothing else needed
#   make run TARGET=...           the same on localhost:4304, i2c:/dev/i2c-1, ...; only reads.
#                                 owserver: on the genuine one, with simulated devices if need be
#   make install uninstall        programs, libraries, pages below PREFIX=/usr/local, and away
#   make install-service          the service for systemd, of what is installed;
#                                 make uninstall-service takes it away
#   make clean                    removes build/
#
#   make test                     unit tests, and the main job by the real programs (sets up what they
#                                 need); TESTS='test_run.py test_shm.py' these system tests alone
#   make unit                     unit tests alone, with each place of each visit of a chip
#   make system                   all system tests; TESTS=test_reload.py some
#   make helpers                  what tests are made with, in a sentence each
#   make rooms                    what each folder of the source is, in a sentence
#   make lint                     the form of all files; make format mends what a program can of it
#   make check                    all suites of tests/suites, in forty minutes; goes on where it was
#                                 broken off. SUITES='kernel gpio' some, AGAIN=1 all of them again
#   make touched                  which of them a change asks for; BASE=main against another commit
#   make check-all                these and the suites of hours, before a release
#
#   make compare                  what owserver and owsd read of the same simulated devices, and what
#                                 becomes of what both write, against what is recorded; WRITE=1
#                                 records it, PARTS='DS2438 DS2450' some
#   make properties-page          docs/properties.md, of what is recorded
#   make devices-page             docs/devices.md, of the tables of the chips
#   make diagrams                 the picture of the alarm machine, of its table
#   make bench                    how fast it is
#   make bench-page               make bench and make bench-kernel into docs/performance.md, with plots
#
#   make clang                    unit tests made by a second compiler; make m32 with 32 bits
#   make asan tsan                unit and system tests with a sanitizer; OF=unit the first alone
#   make sanitize                 both
#   make fuzz                     libFuzzer on what comes from outside; FUZZ=rio one of its targets,
#                                 FUZZ_SECONDS=60 for each
#   make analyze                  what gcc's analyzer, clang-tidy and cppcheck find: nothing may be left
#   make coverage                 which lines and branches the tests reach
#   make mutate                   which faults of one line, in the newest rooms, their unit tests find;
#                                 ROOMS='mqtt web' of these, FAULTS=30 of each, SEED=1
#   make soak                     a month of faults in virtual time; HOURS=24 less of it
#   make test-kill                the writer of the shared memory killed at KILLS=10000 random points
#   make test-power               power cuts at CUTS=500 points of what history writes
#   make test-page                the page's own JavaScript, by node
#   make test-emulated            owsd on the chips of OneWireHub, a common emulation
#   make test-years               YEARS=10 of history: what is kept, its size, trends of it
#   make model                    the protocol of the shared memory, in a weak memory model
#   make hammer-arm64             readers and writer of the shared memory as arm64 code, in qemu
#   make test-kernel              Debian's own kernel and owserver on the simulated chip, in QEMU
#   make bench-kernel             how fast the kernel's ways are, there
#   make endurance-kernel         the same for an hour with faults of everything; MINUTES=2 SEED=1
#   make test-gpio                GPIO lines of an arm64 guest, with libgpiod 1.6 and 2.x;
#                                 make test-gpio-pi the same of a Raspberry Pi 3
#
#   make deb                      Debian packages in build/deb; ARCH=arm64, SUITE=trixie for others
#   make repository               an apt repository of what make deb made, in build/repository, signed
#                                 by REPOSITORY_KEY=FINGERPRINT (docs/repository.md)
#   make addon                    the add-on of Home Assistant, in build/addon, of what make deb made
#                                 (docs/home-assistant-addon.md); ADDON_URL=https://...
#   make dist                     the release as a tarball, of what is committed (docs/release.md)
#   make test-dist                that tarball built and run without git and network
#   make recipes                  for Alpine, Buildroot and Yocto, of that tarball, in build/recipes;
#                                 RECIPES_URL=https://... is where it lies (docs/distributions.md)
#   make oci                      an OCI image of what make deb made, in build/oci; ARCH and SUITE too
#   make test-package             packages of three architectures, lintian, install to purge
#   make test-fresh               the first two commands in new systems of Debian 12 and 13, with
#                                 make alone or with gcc; DEBIAN=bookworm HAVE=gcc AT=tmp
#                                 ORDER=run-test TESTS=test_run.py for less
#   make test-service             the service under systemd in QEMU, with the packages of make deb
#   make test-image               an image for a Raspberry Pi, booted in QEMU; CASES=main for less

VERSION  := 1.0.0
SOMAJOR  := 1
B        ?= build
PREFIX   ?= /usr/local
DESTDIR  ?=
LIBDIR   ?= $(PREFIX)/lib
MANDIR   ?= $(PREFIX)/share/man
DATADIR  ?= $(PREFIX)/share/owsd
BASHDIR  ?= $(PREFIX)/share/bash-completion/completions
ZSHDIR   ?= $(PREFIX)/share/zsh/site-functions

.DEFAULT_GOAL := all

# make takes a name with a blank for two, and clean and uninstall would remove those two
blank    := $() $()
comma    := ,
$(foreach v,CURDIR B PREFIX DESTDIR LIBDIR MANDIR DATADIR,$(if $(findstring $(blank),$($(v))),\
    $(error $(v) is '$($(v))': a folder with a blank in its name cannot be used here)))
$(foreach v,B DATADIR,$(if $($(v)),,$(error $(v) is empty: name a folder)))
# and clean all that B has
$(if $(filter $(abspath $(B))/%,$(CURDIR)/ $(patsubst %,$(CURDIR)/%/,src hal docs tests board)),\
    $(error B is '$(B)': make clean would remove the source; name a folder of its own))

# A compiler of the environment is this machine's, and none for CROSS_COMPILE=aarch64-linux-gnu-
NOT_GIVEN := default undefined $(if $(CROSS_COMPILE),environment)
CC       := $(CROSS_COMPILE)$(if $(filter $(NOT_GIVEN),$(origin CC)),gcc,$(CC))
CXX      := $(CROSS_COMPILE)$(if $(filter $(NOT_GIVEN),$(origin CXX)),g++,$(CXX))
AR       := $(CROSS_COMPILE)$(if $(filter $(NOT_GIVEN),$(origin AR)),ar,$(AR))
OBJCOPY  := $(if $(filter $(NOT_GIVEN),$(origin OBJCOPY)),$(CROSS_COMPILE)objcopy,$(OBJCOPY))
PKG_CONFIG ?= pkg-config
# Other compilers too go through it
CCACHE   := $(if $(filter ccache,$(CC)),ccache )

WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes \
            -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wvla -Wformat=2 \
            -Wno-missing-field-initializers
CXXWARN  := -Wall -Wextra -Wpedantic -Wshadow -Wcast-qual -Wundef -Wvla -Wformat=2
ifeq ($(WERROR),1)
WARN     += -Werror
CXXWARN  += -Werror
endif
CFLAGS   ?= -O2 -g
CXXFLAGS ?= -O2 -g
CPPFLAGS ?=
EXTRA_CFLAGS ?=
# What this compiler has of these; a warning says that it has not
has       = $(shell printf '\043include <stdint.h>\nint main(void) { return 0; }\n' | \
              $(CC) -Werror -O2 $(filter -m%,$(CFLAGS) $(EXTRA_CFLAGS)) $(1) -x c -c -o /dev/null - 2>/dev/null && echo '$(1)')
FORTIFY  := $(or $(call has,-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3),-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
# It wants -O, and yours holds
ifneq ($(findstring _FORTIFY_SOURCE,$(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS))$(filter -O0,$(lastword -O0 $(filter -O%,$(CFLAGS) $(EXTRA_CFLAGS)))),)
FORTIFY  :=
endif
HARDEN   := -fstack-protector-strong $(FORTIFY) -fPIE $(call has,-fstack-clash-protection) \
            $(or $(call has,-fcf-protection),$(call has,-mbranch-protection=standard))
# A program has the functions and tables that it uses, and no others of the files that it needs. A
# sanitizer keeps books of its own of all of them
SECTIONS := $(if $(findstring -fsanitize,$(CFLAGS) $(EXTRA_CFLAGS)),,-ffunction-sections -fdata-sections)
CPP_COMMON = -D_GNU_SOURCE -D_FILE_OFFSET_BITS=64 -I. -DOWSD_VERSION='"$(VERSION)"'
ALL_CFLAGS = -std=c17 $(CPP_COMMON) $(WARN) $(HARDEN) $(SECTIONS) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS)
ALL_CXXFLAGS = -std=c++11 $(CPP_COMMON) $(CXXWARN) $(HARDEN) $(CPPFLAGS) $(CXXFLAGS) $(EXTRA_CFLAGS)
# Relocations as a bitmap, a twentieth of the table, where the C library reads them (glibc 2.36)
RELR     := -Wl,-z,pack-relative-relocs
RELR     := $(shell printf '\043include <stdint.h>\n\043if !defined __GLIBC__ || !__GLIBC_PREREQ(2, 36)\n\043error\n\043endif\nint main(void) { return 0; }\n' | \
              $(CC) $(filter -m%,$(CFLAGS) $(EXTRA_CFLAGS)) -fPIE -pie -Wl,--fatal-warnings $(RELR) -x c -o /dev/null - 2>/dev/null && echo '$(RELR)')
ALL_LDFLAGS = -pie -Wl,-z,relro -Wl,-z,now $(RELR) $(if $(SECTIONS),-Wl$(comma)--gc-sections) $(LDFLAGS) $(EXTRA_CFLAGS)
LIBS     := -Wl,--as-needed -lm -pthread
# Debian's musl-gcc knows its own headers alone; those of the kernel are beside glibc's
ifneq ($(findstring musl-gcc,$(CC)),)
CPP_COMMON += -idirafter /usr/include -idirafter /usr/include/$(shell gcc -print-multiarch)
endif

# I2C adapters, where libi2c is there for this compiler; LIBI2C=0 leaves it out
LIBI2C   ?= $(shell printf '\043include <stdint.h>\n\043include <i2c/smbus.h>\nint main(void) { return i2c_smbus_read_byte(0); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -li2c 2>/dev/null && echo 1)
LIBI2C   := $(LIBI2C)
ifeq ($(LIBI2C),1)
CPP_COMMON += -DOWSD_LIBI2C
LIBS     += -li2c
endif

# GPIO lines, where libgpiod is there for this compiler: 1 the API of 1.6, 2 that of 2.x. The compiler
# is asked which, as pkg-config may speak of this machine's; LIBGPIOD=0 leaves it out
LIBGPIOD_CFLAGS ?= $(shell $(PKG_CONFIG) --cflags libgpiod 2>/dev/null)
LIBGPIOD_CFLAGS := $(LIBGPIOD_CFLAGS)
LIBGPIOD_LIBS ?= $(or $(shell $(PKG_CONFIG) --libs libgpiod 2>/dev/null),-lgpiod)
LIBGPIOD_LIBS := $(LIBGPIOD_LIBS)
gpiod_has = $(shell printf '\043include <gpiod.h>\nint main(void) { return !$(1)(0); }\n' | \
              $(CC) -Werror=implicit-function-declaration $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LIBGPIOD_CFLAGS) \
              $(LDFLAGS) -x c -o /dev/null - $(LIBGPIOD_LIBS) 2>/dev/null && echo 1)
LIBGPIOD ?= $(if $(call gpiod_has,gpiod_chip_get_info),2,$(call gpiod_has,gpiod_chip_name))
LIBGPIOD := $(LIBGPIOD)
ifneq ($(filter 1 2,$(LIBGPIOD)),)
CPP_COMMON += -DOWSD_LIBGPIOD=$(LIBGPIOD) $(LIBGPIOD_CFLAGS)
LIBS     += $(LIBGPIOD_LIBS)
endif

# USB adapters, where libusb is there for this compiler; LIBUSB=0 leaves it out
LIBUSB   ?= $(shell printf '\043include <stdint.h>\n\043include <libusb-1.0/libusb.h>\nint main(void) { return libusb_wrap_sys_device(0, 0, 0); }\n' | \
              $(CC) -Werror=implicit-function-declaration $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lusb-1.0 2>/dev/null && echo 1)
LIBUSB   := $(LIBUSB)
ifeq ($(LIBUSB),1)
CPP_COMMON += -DOWSD_LIBUSB
LIBS     += -lusb-1.0
endif

# owsd-recorder and libows-history, where SQLite is there for this compiler; LIBSQLITE3=0 leaves it out
LIBSQLITE3 ?= $(shell printf '\043include <stdint.h>\n\043include <sqlite3.h>\nint main(void) { return !sqlite3_libversion_number(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lsqlite3 2>/dev/null && echo 1)
LIBSQLITE3 := $(LIBSQLITE3)
SQLITE   := $(filter 1,$(LIBSQLITE3))
LIBS     += $(if $(SQLITE),-lsqlite3)

# owsd-influx and owsd-notify, where libcurl is there for this compiler; LIBCURL=0 leaves it out
LIBCURL  ?= $(shell printf '\043include <stdint.h>\n\043include <curl/curl.h>\nint main(void) { return !curl_multi_init(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lcurl 2>/dev/null && echo 1)
LIBCURL  := $(LIBCURL)
CURL     := $(filter 1,$(LIBCURL))

# owsd-web, where libmicrohttpd is there for this compiler; LIBMICROHTTPD=0 leaves it out
LIBMICROHTTPD ?= $(shell printf '\043include <stdint.h>\n\043include <microhttpd.h>\nint main(void) { return !MHD_get_version(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lmicrohttpd 2>/dev/null && echo 1)
LIBMICROHTTPD := $(LIBMICROHTTPD)
HTTPD    := $(filter 1,$(LIBMICROHTTPD))

# The plots of its page, where the package libjs-dygraphs is; DYGRAPHS= leaves them out
DYGRAPHS ?= $(wildcard /usr/share/javascript/dygraphs/dygraph.min.js)
DYGRAPHS := $(DYGRAPHS)
DYGRAPHS_LICENCE ?= /usr/share/doc/libjs-dygraphs/copyright

# owsd-mqtt, where libmosquitto is there for this compiler; LIBMOSQUITTO=0 leaves it out
LIBMOSQUITTO ?= $(shell printf '\043include <stdint.h>\n\043include <mosquitto.h>\nint main(void) { return mosquitto_lib_init(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lmosquitto 2>/dev/null && echo 1)
LIBMOSQUITTO := $(LIBMOSQUITTO)
MOSQUITTO := $(filter 1,$(LIBMOSQUITTO))

# Its reasons why a certificate is refused, where OpenSSL is, which libmosquitto uses; OPENSSL=0 leaves them out
OPENSSL ?= $(and $(MOSQUITTO),$(shell printf '\043include <openssl/ssl.h>\nint main(void) { return !TLS_client_method(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lssl -lcrypto 2>/dev/null && echo 1))
OPENSSL := $(filter 1,$(OPENSSL))

# The profile sparkplug of owsd-mqtt, where libprotobuf-c and its compiler are; LIBPROTOBUFC=0 leaves it out
PROTOC_C ?= $(or $(and $(shell command -v protoc-gen-c),$(shell command -v protoc)),$(shell command -v protoc-c))
LIBPROTOBUFC ?= $(and $(PROTOC_C),$(shell printf '\043include <stdint.h>\n\043include <protobuf-c/protobuf-c.h>\nint main(void) { return !protobuf_c_version_number(); }\n' | \
              $(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(LDFLAGS) -x c -o /dev/null - -lprotobuf-c 2>/dev/null && echo 1))
LIBPROTOBUFC := $(LIBPROTOBUFC)
PROTOBUFC := $(filter 1,$(LIBPROTOBUFC))
PROTO    := $(if $(PROTOBUFC),$(B)/proto/sparkplug.pb-c)
PROTO_FLAGS := $(if $(PROTOBUFC),-isystem $(B)/proto -DOWSD_PROTOBUFC)

# With what is compiled and linked: a file for each, written when that has changed, and never else.
# What depends on it is made again then
version_of = $(shell $(1) --version 2>/dev/null | head -n 1)
with_cc  := $(CC): $(call version_of,$(CC)): $(ALL_CFLAGS)
with_cxx := $(CXX): $(call version_of,$(CXX)): $(ALL_CXXFLAGS)
with_ld  := $(CC): $(ALL_LDFLAGS) $(LIBS)
with_libraries := libi2c $(if $(filter 1,$(LIBI2C)),yes,no) libusb $(if $(filter 1,$(LIBUSB)),yes,no) libgpiod $(or $(filter 1 2,$(LIBGPIOD)),no) \
    libsqlite3 $(if $(SQLITE),yes,no owsd-recorder left-out) libcurl $(if $(CURL),yes,no owsd-influx left-out owsd-notify left-out) \
    libmicrohttpd $(if $(HTTPD),yes,no owsd-web left-out) libmosquitto $(if $(MOSQUITTO),yes,no owsd-mqtt left-out) \
    dygraphs $(if $(DYGRAPHS),yes,no plots left-out) libprotobuf-c $(if $(PROTOBUFC),yes,no) openssl $(if $(OPENSSL),yes,no)
compiler := $(firstword $(filter-out ccache,$(CC)))
WITH     := $(patsubst %,$(B)/with/%,cc cxx ld libraries)
same      = $(and $(findstring x$(1)x,x$(2)x),$(findstring x$(2)x,x$(1)x))
$(foreach f,$(WITH),$(if $(call same,$(strip $(with_$(notdir $(f)))),$(strip $(file <$(f)))),,$(eval $(f): FORCE)))

# V=1 shows the commands, -s nothing
V        ?= 0
Q        := $(if $(filter 1,$(V)),,@)
quiet    := $(findstring s,$(filter-out --%,$(firstword -$(MAKEFLAGS))))
show      = $(if $(Q),$(if $(quiet),,@echo "  $(step)$(1)	$@"))
# Of how many files this is which, where make test has counted them
step      = $(if $(STEPS),$(eval MADE += x)$(words $(MADE))/$(STEPS) )

# What objects and programs are made with; $(1) are flags of their own
define compile
@mkdir -p $(@D)
$(call show,CC)
$(Q)$(CC) $(ALL_CFLAGS) $(1) -MMD -MP -c -o $@ $<
endef
define link
@mkdir -p $(@D)
$(call show,LD)
$(Q)$(CC) $(ALL_LDFLAGS) $(1) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS)
endef
define program
@mkdir -p $(@D)
$(call show,CC)
$(Q)$(CC) $(ALL_CFLAGS) $(1) $(ALL_LDFLAGS) -MMD -MP -o $@ $(filter %.c %.a,$^) $(LIBS)
endef

# --- The rooms: each is a folder, of source and of unit tests; its main header says what it is, and
# tests/lint/rooms.txt which others it may use
SOURCES  := $(wildcard src/*/*/*.c src/*/*/*/*.c hal/*/*.c hal/*/*/*.c)
# Of owsd-web: what must be in no other program; and what calls libmicrohttpd
WEB_ALONE := src/faces/web/no_tls.c src/faces/web/wire.c
WEB_HTTP := $(WEB_ALONE) $(patsubst %,src/faces/web/%.c,api command devices draft events http lists past save stored stream)
# Of owsd-mqtt: what calls libmosquitto
MQTT_ALL := $(patsubst %,src/faces/mqtt/%.c,mqtt arrivals broker client advice)
# The consumers' library
LIBOWS   := $(wildcard src/memory/libows/*.c)
# And the one that reads history
LIBHISTORY := $(filter-out src/history/library/none.c,$(wildcard src/history/library/*.c))
# What is of use with SQLite alone; faces without it keep files of theirs by place.c
SQLITE_ALL := $(LIBHISTORY) $(filter-out %/place.c,$(wildcard src/history/file/*.c)) $(wildcard src/history/recorder/*.c)
# What makes of owsd the program owsd-sim
SIM_TABLE := hal/sim/table.c
# Programs to start from, and configurations
EXAMPLES := $(wildcard docs/examples/*.c docs/examples/*.cpp docs/examples/*.py docs/examples/*.go \
            docs/examples/*.rio docs/examples/*.rs docs/examples/*.table)
# Those that another program builds or loads, a folder for each
HOSTED   := $(patsubst docs/examples/%/,%,$(wildcard docs/examples/*/))
PYTHON   := $(wildcard src/memory/libows/*.py)
# What the browser gets of owsd-web: the files of src/faces/web/page, and the library of its plots
WEBPAGE  := $(notdir $(wildcard src/faces/web/page/*)) $(notdir $(DYGRAPHS))
MAN      := $(wildcard docs/*.[1-8])
# Tests
UNIT_SRC := $(filter-out $(if $(CURL),,%/test_post.c $(wildcard tests/unit/notify/*.c)) $(if $(PROTOBUFC),,%/test_sparkplug.c) $(if $(MOSQUITTO),,%/test_advice.c) $(if $(SQLITE),,%_past.c %/test_sending.c $(wildcard $(patsubst %,tests/unit/%/*.c,file library recorder))),$(wildcard tests/unit/*/test_*.c))
UNIT_AID := $(filter-out %/published.c %/past.c $(if $(SQLITE),,%/power_file.c),$(wildcard tests/unit/aid/*.c))
ENDURANCE := $(wildcard tests/endurance/*.c)
BENCH    := $(filter-out $(if $(SQLITE),,%/bench_history.c %/bench_recorder.c),$(wildcard tests/bench/bench_*.c))
BENCH_AID := $(filter-out tests/bench/bench_%,$(wildcard tests/bench/*.c)) $(SIM_TABLE) tests/unit/aid/plant.c tests/unit/aid/plant_net.c tests/unit/aid/giving.c
# ---------------------------------------------------------------------------------------------

# With main()
FACE_MAIN := $(wildcard src/*/*/owsd_*.c)
CORE     := $(filter-out src/daemon/owsd/owsd.c src/tool/owsctl/owsctl.c $(FACE_MAIN) $(SIM_TABLE) $(if $(SQLITE),src/history/library/none.c,$(SQLITE_ALL)) \
            $(if $(CURL),,src/faces/kit/post.c) $(if $(HTTPD),$(WEB_ALONE),$(WEB_HTTP)) $(if $(MOSQUITTO),,$(MQTT_ALL)) \
            $(if $(PROTOBUFC),,src/faces/mqtt/sparkplug.c),$(SOURCES))
obj       = $(patsubst %.c,$(B)/%.o,$(1))
UNIT     := $(patsubst %.c,$(B)/unit/%,$(notdir $(UNIT_SRC))) $(B)/unit/test_endurance
BENCHES  := $(patsubst tests/bench/%.c,$(B)/bench/%,$(BENCH))
SAMPLES  := $(patsubst docs/examples/%.c,$(B)/examples/%,$(filter-out $(if $(SQLITE),,%/past.c),$(filter %.c,$(EXAMPLES)))) \
            $(patsubst docs/examples/%.cpp,$(B)/examples/%,$(filter %.cpp,$(EXAMPLES)))
# Programs beside owsd, by their table: name:library:socket, the last of those that a socket starts
FACE_ROWS := $(shell awk -F ' *[|] *' '/^owsd/ { print $$1 ":" $$2 ":" ($$6 == "-" ? "socket" : "") }' board/faces)
ALL_FACES := $(foreach f,$(FACE_ROWS),$(firstword $(subst :, ,$(f))))
FACES    := $(foreach f,$(FACE_ROWS),$(if $(filter -,$(word 2,$(subst :, ,$(f))))$($(word 2,$(subst :, ,$(f)))),$(firstword $(subst :, ,$(f)))))
# Started by their sockets
SOCKETED := $(foreach f,$(FACE_ROWS),$(if $(word 3,$(subst :, ,$(f))),$(firstword $(subst :, ,$(f)))))
# Those that open targets, each again as NAME-sim: the same with the scheme sim
WITH_SIM := owsd-sim owsd-writer-sim owsctl-sim
PROGRAMS := $(B)/owsd $(B)/owsctl $(FACES:%=$(B)/%) $(WITH_SIM:%=$(B)/%)
LIBRARIES := libows $(if $(SQLITE),libows-history)
PYTHON_MADE := $(if $(PYTHON),$(B)/python/ows.py $(LIBRARIES:%=$(B)/python/%.so.$(SOMAJOR)))
LIBRARY  := $(foreach l,$(LIBRARIES),$(B)/$(l).so.$(VERSION) $(B)/$(l).a $(B)/$(l).pc)

.PHONY: all unit soak system test run bench bench-page install uninstall install-service uninstall-service \
        deb repository addon test-package test-service test-fresh dist test-dist clean \
        examples unit-programs benches system-programs diagrams compare properties-page devices-page \
        check check-all touched mutate helpers rooms help FORCE
all: $(PROGRAMS) $(LIBRARY) $(PYTHON_MADE) $(WEBPAGE:%=$(B)/page/%) $(WEBPAGE:%=$(B)/page/%.gz) $(B)/core.a $(B)/with/libraries

# Two makes may do this at once
$(WITH): $(B)/with/%:
	$(if $(filter cc,$*),@command -v $(compiler) >/dev/null || { \
	    echo "make: there is no C compiler $(compiler): sh board/install-deps build" >&2; exit 1; })
	@mkdir -p $(@D)
	@printf '%s\n' '$(subst ','\'',$(with_$*))' >$@.$$$$ && mv $@.$$$$ $@
	$(if $(filter libraries,$*),$(if $(quiet),,@sed 's/^/  WITH	/' $@))

$(B)/%.o: %.c $(B)/with/cc
	$(call compile,$(PIC))

# The page as owsd-web serves it from the build: links, so that a change shows at the next reload
$(B)/page/%: src/faces/web/page/%
	@mkdir -p $(@D)
	@ln -sf $(abspath $<) $@
$(DYGRAPHS:%=$(B)/page/$(notdir $(DYGRAPHS))): $(DYGRAPHS)
	@mkdir -p $(@D)
	@ln -sf $(abspath $<) $@

# What a browser gets in place of them
$(B)/page/%.gz: $(B)/page/%
	@gzip -9n <$< >$@.new && mv $@.new $@

# Everything but main(): what the programs and the unit tests link
$(B)/core.a: $(call obj,$(CORE)) $(PROTO:%=%.o)
	@mkdir -p $(@D)
	@rm -f $@
	$(call show,AR)
	$(Q)$(AR) rcs $@ $^

# What is made of the .proto file; which files know of it
$(B)/proto/%.pb-c.c $(B)/proto/%.pb-c.h: src/faces/mqtt/%.proto
	@mkdir -p $(@D)
	$(call show,PROTO)
	$(Q)$(PROTOC_C) -Isrc/faces/mqtt --c_out=$(@D) $<
$(B)/proto/%.o: $(B)/proto/%.c $(B)/with/cc
	$(call compile,-w)
WITH_PROTO := $(call obj,$(patsubst %,src/%.c,config/read/texts faces/mqtt/profiles faces/mqtt/sparkplug))
$(WITH_PROTO): PIC := $(PROTO_FLAGS)
$(B)/tests/unit/config/test_config_mqtt.o: UNITY_FLAGS += $(PROTO_FLAGS)
$(WITH_PROTO) $(B)/tests/unit/config/test_config_mqtt.o: $(B)/with/libraries
$(B)/src/faces/mqtt/sparkplug.o: $(PROTO:%=%.h)

$(PROGRAMS): $(B)/core.a $(B)/with/ld
	$(call link)
$(WITH_SIM:%=$(B)/%): $(call obj,$(SIM_TABLE))
$(B)/owsd $(B)/owsd-sim: $(B)/src/daemon/owsd/owsd.o
$(B)/owsctl $(B)/owsctl-sim: $(B)/src/tool/owsctl/owsctl.o
$(foreach f,$(FACES),$(eval $(B)/$f: $(call obj,$(filter %/$(subst -,_,$f).c,$(FACE_MAIN)))))
$(B)/owsd-writer-sim: $(B)/src/faces/writer/owsd_writer.o
$(B)/owsd-influx $(B)/owsd-notify: LIBS += -lcurl
$(B)/owsd-mqtt: LIBS += -lmosquitto $(if $(PROTOBUFC),-lprotobuf-c) $(if $(OPENSSL),-lssl -lcrypto)
$(B)/src/faces/mqtt/client.o: PIC := $(if $(OPENSSL),-DOWSD_OPENSSL)
$(B)/src/faces/mqtt/client.o: $(B)/with/libraries
$(B)/owsd-web: $(call obj,$(WEB_ALONE))
$(B)/owsd-web: LIBS += -lmicrohttpd -Wl,--export-dynamic-symbol=_gnutls_global_init_skip

# --- libows exports ows_* and nothing else, libows-history ows_history_* -----------------------
# Of the daemon's sources they take what they need out of these; they go into the programs as they are
LIBOWS_AID := $(call obj,$(wildcard src/memory/shm/*.c src/ground/signal/*.c))
LIBHISTORY_AID := $(call obj,$(wildcard src/history/file/*.c))
$(call obj,$(LIBOWS) $(LIBHISTORY)) $(LIBOWS_AID) $(LIBHISTORY_AID): PIC := -fPIC -fno-semantic-interposition
libows_EXPORTS := ows_*
libows-history_EXPORTS := ows_history_*
$(B)/libows.so.$(VERSION) $(B)/libows.a: $(call obj,$(LIBOWS)) $(B)/libows/aid.a
$(B)/libows-history.so.$(VERSION) $(B)/libows-history.a: $(call obj,$(LIBHISTORY)) $(B)/libows/history.a \
    $(B)/libows/aid.a

$(B)/libows/aid.a: $(LIBOWS_AID)
$(B)/libows/history.a: $(LIBHISTORY_AID)
$(B)/libows/aid.a $(B)/libows/history.a:
	@mkdir -p $(@D)
	@rm -f $@
	$(call show,AR)
	$(Q)$(AR) rcs $@ $^

$(B)/libows/%.map:
	@mkdir -p $(@D)
	@echo '{ global: $($*_EXPORTS); local: *; };' > $@

$(LIBRARIES:%=$(B)/%.so.$(VERSION)): $(B)/%.so.$(VERSION): $(B)/libows/%.map $(B)/with/ld
	$(call show,LD)
	$(Q)$(CC) -shared -Wl,-soname,$*.so.$(SOMAJOR) -Wl,--version-script,$(B)/libows/$*.map \
	    -Wl,-z,relro -Wl,-z,now $(if $(findstring sanitize,$(EXTRA_CFLAGS)),,-Wl,-z,defs) \
	    $(LDFLAGS) $(EXTRA_CFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS)
	@ln -sf $(@F) $(B)/$*.so.$(SOMAJOR)
	@ln -sf $(@F) $(B)/$*.so

# Of a section group only the signature would be made local, and the linker would take another's
# members for it: without groups, where the linker can
ONE_GROUP = $(shell $(CC) -Wl,--help 2>/dev/null | grep -q force-group-allocation && \
              echo -Wl,--force-group-allocation)
$(LIBRARIES:%=$(B)/%.a): $(B)/%.a:
	$(call show,AR)
	@rm -f $@
	$(Q)$(CC) $(filter -m%,$(CFLAGS) $(EXTRA_CFLAGS)) -r -nostdlib $(ONE_GROUP) -o $(B)/libows/$*-one.o $^
	$(Q)$(OBJCOPY) --wildcard --keep-global-symbol='$($*_EXPORTS)' $(B)/libows/$*-one.o
	$(Q)$(AR) rcs $@ $(B)/libows/$*-one.o

# What Python loads: ows.py, and its libraries beside it. One that this machine's Python cannot load (of
# a sanitizer, of another processor) is compiled again, for this machine
HOSTCC   ?= cc
$(B)/python/ows.py: src/memory/libows/ows.py
	@mkdir -p $(@D)
	@ln -sf $(abspath $<) $@
$(LIBRARIES:%=$(B)/python/%.so.$(SOMAJOR)): $(B)/python/%.so.$(SOMAJOR): $(B)/%.so.$(VERSION)
	@mkdir -p $(@D)
	@ln -sf ../$(@F) $@
	$(if $(filter libows,$*),@! command -v python3 >/dev/null || $(call python_loads,$@) || $(call for_python,$@) || \
	    echo 'make: $(HOSTCC) makes no libows for python3: ows.py in $(@D) will not work' >&2)

python_loads = python3 -c 'import ctypes; ctypes.CDLL("$(abspath $(1))")' 2>/dev/null
for_python   = { rm $(1) && $(HOSTCC) -std=c17 -O1 $(CPP_COMMON) -shared -fPIC -ffunction-sections \
    -Wl,--gc-sections,-z,defs -Wl,--version-script,$(B)/libows/libows.map -o $(1) $(LIBOWS) \
    $(wildcard src/memory/shm/*.c src/ground/signal/*.c) -lm -pthread; }

# PREFIX may differ from one call to the next, and two makes may do this at once
libows_SAYS := Signals of owsd, the 1-Wire daemon, in shared memory
libows-history_SAYS := What the signals of owsd, the 1-Wire daemon, were, as its recorder kept it
libows-history_PRIVATE := -lsqlite3
$(LIBRARIES:%=$(B)/%.pc): $(B)/%.pc: FORCE
	@mkdir -p $(@D)
	@printf '%s\n' 'prefix=$(PREFIX)' 'libdir=$(LIBDIR)' 'includedir=$${prefix}/include' '' \
	    'Name: $*' 'Description: $($*_SAYS)' \
	    'Version: $(VERSION)' 'Libs: -L$${libdir} -l$(*:lib%=%)' 'Libs.private: $($*_PRIVATE) -lm -pthread' \
	    'Cflags: -I$${includedir}' >$@.$$$$ && mv $@.$$$$ $@

# --- Examples ---------------------------------------------------------------------------------
examples: $(SAMPLES)

$(B)/examples/%: docs/examples/%.c $(B)/libows.a $(if $(SQLITE),$(B)/libows-history.a) $(B)/with/cc $(B)/with/ld
	$(call program,-Isrc/public)

$(B)/examples/%: docs/examples/%.cpp $(B)/libows.a $(B)/with/cxx $(B)/with/ld
	@mkdir -p $(@D)
	$(call show,CXX)
	$(Q)$(CXX) $(ALL_CXXFLAGS) -Isrc/public $(ALL_LDFLAGS) -MMD -MP -o $@ $(filter %.cpp %.a,$^) $(LIBS)

# --- Unit tests: Unity, one program for each file ---------------------------------------------
# In the source only where B is
UNITY    ?= $(if $(filter $(CURDIR)/build $(CURDIR)/build/%,$(abspath $(B))),build,$(B))/unity
UNITY_FLAGS := -isystem $(UNITY) -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64

# One script makes all three files; the header stands for them. UNITY=DIR takes a copy of yours
$(sort build/unity/unity.h $(B)/unity/unity.h): board/fetch-unity
	sh board/fetch-unity $(@D)
	@touch $@

$(B)/unit/unity.o: $(UNITY)/unity.h $(B)/with/cc
	@mkdir -p $(@D)
	$(call show,CC)
	$(Q)$(CC) -std=c17 $(CPP_COMMON) $(CPPFLAGS) $(CFLAGS) $(EXTRA_CFLAGS) $(UNITY_FLAGS) -fPIE -w -c -o $@ $(UNITY)/unity.c

$(B)/tests/unit/%.o: tests/unit/%.c $(UNITY)/unity.h $(B)/with/cc
	$(call compile,$(UNITY_FLAGS))

$(foreach t,$(UNIT_SRC),$(eval $(B)/unit/$(basename $(notdir $(t))): $(call obj,$(t))))
MQTT_UNITS := $(patsubst tests/unit/mqtt/%.c,$(B)/unit/%,$(wildcard tests/unit/mqtt/*.c))
$(MQTT_UNITS): LIBS += $(PROTOBUFC:1=-lprotobuf-c) $(MOSQUITTO:1=-lmosquitto)
$(MQTT_UNITS): $(B)/tests/unit/aid/published.o
# It has names of src/faces/mqtt/past.c
$(if $(SQLITE),$(filter-out $(MQTT_UNITS) %/test_endurance,$(UNIT)): $(B)/tests/unit/aid/past.o)
$(filter-out %/test_endurance,$(UNIT)): $(B)/unit/unity.o $(call obj,$(UNIT_AID)) $(B)/core.a $(B)/with/ld
	$(call link)

$(B)/unit/test_post $(patsubst tests/unit/notify/%.c,$(B)/unit/%,$(wildcard tests/unit/notify/*.c)): LIBS += -lcurl

$(patsubst %,$(B)/unit/test_%,python recorded recorded_later): | $(PYTHON_MADE)

$(B)/unit/endurance/%.o: tests/endurance/%.c $(UNITY)/unity.h $(B)/with/cc
	$(call compile,$(UNITY_FLAGS))

# What the engine's thread allocates is counted, and the kernel's files are answered by the test
ENDURANCE_WRAPS := malloc calloc realloc aligned_alloc strdup free open open64 read __read_chk write \
                   close
$(B)/unit/test_endurance: $(patsubst tests/endurance/%.c,$(B)/unit/endurance/%.o,$(ENDURANCE)) \
    $(B)/unit/unity.o $(call obj,$(UNIT_AID)) $(B)/core.a $(B)/with/ld
	$(call link,$(patsubst %,-Wl$(comma)--wrap=%,$(ENDURANCE_WRAPS)))

unit-programs: $(UNIT) replays

# RUNNER runs programs of another architecture: RUNNER=qemu-aarch64-static.
# UNIT_WITHOUT=test_rio leaves programs out; ROOMS='shm host' takes those of these rooms alone
unit: export RUNNER := $(RUNNER)
OF_ROOMS := $(patsubst %.c,$(B)/unit/%,$(notdir $(wildcard $(ROOMS:%=tests/unit/%/test_*.c))))
UNIT_RUN := $(filter-out $(UNIT_WITHOUT:%=$(B)/unit/%),$(if $(ROOMS),$(OF_ROOMS),$(UNIT)))
unit: $(if $(ROOMS),,all replays) $(UNIT_RUN)
	@sh tests/unit/run $(UNIT_RUN) $(if $(ROOMS),,$(REPLAYS))

# For UNIT_WITHOUT. These compute for minutes, with one thread, and what they say of chips they say
# with any compiler
LONG_UNITS := test_route_soak test_visit_%
# In these rooms nothing starts a thread, unless a test of them does itself
ONE_THREAD_ROOMS := chips config ds2482 engine native sim signal
ONE_THREAD_UNITS = $(notdir $(basename $(shell grep -L -E '<pthread\.h>|/(control_scene|door|peer)\.h"|_thread\.h"' \
                   $(wildcard $(ONE_THREAD_ROOMS:%=tests/unit/%/test_*.c)))))
.PHONY: long-units one-thread-units
long-units:
	@echo $(filter $(LONG_UNITS),$(notdir $(UNIT)))
one-thread-units:
	@echo $(ONE_THREAD_UNITS) test_endurance

# A month of faults in virtual time on every backend, five minutes of a processor; HOURS=168 is a
# week in one. SEED=1, WORLD=native for one of them
soak: all $(B)/unit/test_endurance
	@$(B)/unit/test_endurance $(or $(HOURS),720) $(or $(SEED),1) $(WORLD)

# Power cuts in a test of make unit, but many more
.PHONY: test-power
test-power: $(B)/unit/test_history_power
	@POWER_CUTS=$(or $(CUTS),500) $<

# Likewise years of it
.PHONY: test-years
test-years: $(B)/unit/test_history_years
	@HISTORY_YEARS=$(or $(YEARS),10) $<

# --- System tests, benches and the main job ---------------------------------------------------
# Programs that system tests command
SYSTEM_AIDS := $(patsubst tests/system/%.c,$(B)/system/%,$(wildcard tests/system/*.c)) \
               $(patsubst tests/system/preload/%.c,$(B)/system/%.so,$(wildcard tests/system/preload/*.c))
$(B)/system/ownet: LIBS += $(if $(wildcard /usr/include/ownetapi.h),-lownet)

$(B)/system/%: tests/system/%.c $(B)/core.a $(B)/with/cc $(B)/with/ld
	$(call program)

# For LD_PRELOAD: never with a sanitizer, whose own it would be
$(B)/system/%.so: tests/system/preload/%.c $(B)/with/cc
	@mkdir -p $(@D)
	$(call show,LD)
	$(Q)$(CC) -std=c17 $(WARN) $(CPPFLAGS) $(CFLAGS) -shared -fPIC -o $@ $< -ldl

system: all examples $(SYSTEM_AIDS)
	@OWSD_BUILD=$(abspath $(B)) python3 tests/system/run $(TESTS:%=tests/system/%)

system-programs: $(SYSTEM_AIDS)

# owsd on OneWireHub's own classes, behind the simulator's wire
.PHONY: test-emulated
JUDGE_HUB := $(B)/tests/emulated/test_hub.o $(B)/tests/emulated/wrap.o
$(JUDGE_HUB): $(B)/tests/emulated/%.o: tests/emulated/%.c $(UNITY)/unity.h $(B)/with/cc
	$(call compile,$(UNITY_FLAGS))
test-emulated: $(JUDGE_HUB) $(B)/unit/unity.o $(call obj,$(UNIT_AID)) $(if $(SQLITE),$(B)/tests/unit/aid/past.o) $(B)/core.a
	@CXX='$(CXX)' OBJCOPY='$(OBJCOPY)' sh tests/emulated/run $(B)/emulated/judge $^ $(LIBS)

# The page's own JavaScript, as far as it touches no document
.PHONY: test-page
test-page:
	@B=$(B) python3 tests/page/run

# The gate's part of the tests, with all processors unless -j says another number. Of the places of a
# visit one in VISIT_STRIDE is tried, as make unit tries each of them.
# Tools may be missing before install-deps ran: so make is asked again after it
test: export VISIT_STRIDE ?= 7
test:
	@sh board/install-deps build run test
	@case "$$MAKEFLAGS" in *-j*) jobs= ;; *) jobs=-j$$(nproc) ;; esac; \
	what='all examples $(if $(TESTS),,unit-programs) system-programs'; \
	n=$$($(MAKE) -n V=0 --no-print-directory $$what | grep -c '^echo "  ') || true; \
	$(if $(quiet),,echo "make test: $$n files to make, then the tests";) \
	$(MAKE) --no-print-directory $$jobs STEPS=$$n $$what && \
	if [ -n '$(TESTS)' ]; then $(MAKE) --no-print-directory $$jobs system; \
	else TESTS="$$(python3 tests/check --tests test)" sh tests/both $(MAKE) --no-print-directory $$jobs; fi

# A compiler is enough for the simulation
run:
ifneq ($(TARGET),)
	@sh board/install-deps build $(if $(filter owserver,$(TARGET)),run)
else
	@$(if $(call has,-O2),,sh board/install-deps build)
endif
	@$(MAKE) --no-print-directory all
	@exec env OWSD_BUILD=$(abspath $(B)) sh board/demo/run '$(TARGET)'

benches: all $(BENCHES) $(B)/system/serial $(B)/system/serial.so

$(B)/bench/%: tests/bench/%.c $(BENCH_AID) $(B)/core.a $(B)/with/cc $(B)/with/ld
	$(call program)

bench:
	@sh board/install-deps build bench
	@$(MAKE) --no-print-directory benches
	@for b in $(BENCHES); do $$b || exit 1; done

# make bench three times and make bench-kernel, to docs/performance.md; PAGE=--saved writes it anew
bench-page:
	@sh board/install-deps build bench kernel
	@$(MAKE) --no-print-directory benches kernel-programs
	@CC='$(CC)' python3 tests/bench/page --build $(B) $(PAGE)

include tests/kernel/kernel.mk
include tests/model/model.mk
include tests/image/image.mk
include tests/fuzz/fuzz.mk
include tests/analyze/analyze.mk

# The head of this file
help:
	@sed -n '/^VERSION/q; /^#   make/,$$ s/^# \{0,3\}//p' $(firstword $(MAKEFILE_LIST))

# --- The ladder: tests/suites has the suites, tests/check runs them ------------------------------
check:
	$(if $(SUITES)$(filter undefined,$(origin SUITES)),,$(error SUITES is empty: name suites, or none, or leave it out))
	@B=$(B) python3 tests/check $(if $(AGAIN),--again) $(or $(SUITES),--rung check)
check-all:
	@B=$(B) python3 tests/check $(if $(AGAIN),--again) --rung hours
touched:
	@python3 tests/check --touched $(BASE)
# One that is not found is a line that no unit test holds
mutate: all
	@B=$(B) WERROR=$(WERROR) python3 tests/mutate $(FAULTS:%=--faults %) $(SEED:%=--seed %) $(ROOMS)

# --- Diagrams: made of the program's own tables, and kept beside the pages that show them -------
diagrams:
	python3 docs/alarm-states.py >docs/img/alarm-states.svg.new
	mv docs/img/alarm-states.svg.new docs/img/alarm-states.svg

# --- What tests are made with: the first line of each file of it ---------------------------------
helpers:
	@awk 'FNR == 1 { said = 0 } !said && /^(\/\* [^S]| \* |""")/ { said = 1; \
		gsub(/^(\/\* | \* |""")|( \*\/|""")$$/, ""); printf "%-34s %s\n", FILENAME, $$0 }' \
		tests/unit/aid/*.h $(filter-out tests/system/test_%,$(wildcard tests/system/*.py))

# --- The rooms: what the main file of each says --------------------------------------------------
rooms:
	@sed -n '/^\(\/\*\| \*\) Room [sh][^ ]*\/[^ ]*:/{:more;/\. *\(\*\/\)\?$$/!{N;s/\n *\**//;t more};s/^[^R]*Room //;s/ *\*\/$$//;p}' \
		$(SOURCES) $(wildcard src/*/*/*.h hal/*/*.h hal/*/*/*.h)

# --- The same properties by owserver and by owsd ----------------------------------------------
compare: all $(SYSTEM_AIDS)
	@OWSD_BUILD=$(abspath $(B)) python3 tests/system/compare.py $(if $(WRITE),--write) $(PARTS)
	@$(if $(PARTS),,OWSD_BUILD=$(abspath $(B)) python3 tests/system/compare_virtual.py)
	@OWSD_BUILD=$(abspath $(B)) python3 tests/system/compare_writes.py $(if $(WRITE),--write) $(PARTS)

properties-page: all
	@OWSD_BUILD=$(abspath $(B)) python3 docs/properties.py >docs/properties.md.new
	mv docs/properties.md.new docs/properties.md

devices-page: $(B)/system/families
	@OWSD_BUILD=$(abspath $(B)) python3 docs/devices.py >docs/devices.md.new
	mv docs/devices.md.new docs/devices.md

# --- Install ----------------------------------------------------------------------------------
D := $(DESTDIR)
# The page for Cockpit: the same files, and Cockpit's own library
COCKPIT := $(D)$(PREFIX)/share/cockpit/owsd
install: all
	install -d $(D)$(PREFIX)/bin $(D)$(PREFIX)/sbin $(D)$(PREFIX)/include $(D)$(LIBDIR)/pkgconfig \
	    $(D)$(DATADIR)/examples $(D)$(DATADIR)/boards
	install -m 755 $(B)/owsd $(FACES:%=$(B)/%) $(patsubst %,$(B)/%,$(filter owsd%,$(WITH_SIM))) $(D)$(PREFIX)/sbin
	install -d $(D)$(DATADIR)/web $(COCKPIT)
	install -m 644 $(WEBPAGE:%=$(B)/page/%) $(WEBPAGE:%=$(B)/page/%.gz) $(D)$(DATADIR)/web
	install -m 644 $(WEBPAGE:%=$(B)/page/%) $(COCKPIT)
	$(if $(DYGRAPHS),install -m 644 $(DYGRAPHS_LICENCE) $(D)$(DATADIR)/dygraphs.copyright)
	sed -e 's,^<script type="module" async,<script src="../base1/cockpit.js"></script>\n&,' \
	    -e '/rel="manifest"/d' \
	    src/faces/web/page/index.html >$(COCKPIT)/index.html
	install -m 644 board/cockpit/manifest.json $(COCKPIT)
	install -m 755 $(B)/owsctl $(B)/owsctl-sim $(D)$(PREFIX)/bin
	@set -e; for l in $(LIBRARIES); do so=$$l.so.$(VERSION); \
	    install -m 644 $(B)/$$so $(B)/$$l.a $(D)$(LIBDIR); \
	    ln -sf $$so $(D)$(LIBDIR)/$$l.so.$(SOMAJOR); ln -sf $$so $(D)$(LIBDIR)/$$l.so; \
	    install -m 644 $(B)/$$l.pc $(D)$(LIBDIR)/pkgconfig; done
	install -m 644 $(wildcard src/public/*.h) $(D)$(PREFIX)/include
	install -m 644 $(EXAMPLES) $(D)$(DATADIR)/examples
	@set -e; for h in $(HOSTED); do d=$(D)$(DATADIR)/examples/$$h; install -d $$d; \
	    install -m 644 docs/examples/$$h/* $$d; done
	install -m 644 $(PYTHON) $(D)$(DATADIR)
	install -m 644 $(wildcard board/boards/*.board) $(D)$(DATADIR)/boards
	install -m 644 board/faces $(D)$(DATADIR)
	@set -e; day=$$(sh board/make-deb --day); dd=$$(LC_ALL=C date -u -d "$$day" '+%B %-d, %Y'); \
	for m in $(MAN); do d=$(D)$(MANDIR)/man$${m##*.}; install -d $$d; install -m 644 $$m $$d; \
	    sed -e "s/^\(\.TH [^ ]* [0-9]\) \"\"/\1 \"$$day\"/" -e "s/^\.Dd.*/.Dd $$dd/" $$m >$$d/$${m##*/}; done
	install -d $(D)$(BASHDIR) $(D)$(ZSHDIR)
	install -m 644 board/completion/owsctl.bash $(D)$(BASHDIR)/owsctl
	ln -sf owsctl $(D)$(BASHDIR)/owsctl-sim
	install -m 644 board/completion/_owsctl $(D)$(ZSHDIR)/_owsctl
	$(if $(D),,-@ldconfig 2>/dev/null || true)

uninstall:
	rm -f $(addprefix $(D)$(PREFIX)/sbin/,owsd $(ALL_FACES) owsd-sim owsd-writer-sim) \
	    $(D)$(PREFIX)/bin/owsctl $(D)$(PREFIX)/bin/owsctl-sim \
	    $(foreach l,$(LIBRARIES),$(foreach s,so.$(VERSION) so.$(SOMAJOR) so a,$(D)$(LIBDIR)/$(l).$(s)) \
	    $(D)$(LIBDIR)/pkgconfig/$(l).pc) \
	    $(D)$(PREFIX)/include/ows.h $(D)$(PREFIX)/include/ows_history.h $(D)$(PREFIX)/include/ows_layout.h
	rm -f $(foreach m,$(MAN),$(D)$(MANDIR)/man$(patsubst .%,%,$(suffix $(m)))/$(notdir $(m)))
	rm -f $(D)$(BASHDIR)/owsctl $(D)$(BASHDIR)/owsctl-sim $(D)$(ZSHDIR)/_owsctl
	rm -rf $(D)$(DATADIR) $(COCKPIT)

# The service, where systemd and udev look: below PREFIX they do in /usr and /usr/local, else in /etc.
# The unit names the owsd of PREFIX; what has to be done once is said
SERVICE   := systemd/system/owsd@.service systemd/system/owsd.service sysusers.d/owsd.conf \
             tmpfiles.d/owsd.conf modules-load.d/owsd.conf udev/rules.d/60-owsd.rules \
             $(foreach f,$(ALL_FACES),systemd/system/$f@.service sysusers.d/$f.conf \
             systemd/system/$(if $(filter $(SOCKETED),$f),$f@.socket,$f.service)) tmpfiles.d/owsd-writer.conf
SERVICE_PREFIX := $(abspath $(PREFIX))
SERVICE_IN := $(D)$(if $(filter /usr /usr/local,$(SERVICE_PREFIX)),$(SERVICE_PREFIX)/lib,/etc)
install-service:
	@case '$(PREFIX)' in /*) ;; *) \
	    echo "install-service: PREFIX is '$(PREFIX)': the unit needs the whole path, as /opt"; exit 1; esac
	@case '$(SERVICE_PREFIX)' in *[!A-Za-z0-9/._+-]*) \
	    echo "install-service: PREFIX is '$(PREFIX)': a unit takes letters, digits and . _ + - alone"; exit 1; esac
	@case '$(SERVICE_PREFIX)/' in /home/*|/root/*|/run/user/*|/tmp/*|/var/tmp/*) \
	    echo "install-service: PREFIX is '$(PREFIX)': the service sees no home and no /tmp; take another, as /opt"; \
	    exit 1; esac
	install -d $(addprefix $(SERVICE_IN)/,$(sort $(dir $(SERVICE)))) $(D)/etc/owsd
	@set -e; for u in owsd $(FACES); do f=$(SERVICE_IN)/systemd/system/$$u; \
	    sed 's,@SBINDIR@,$(SERVICE_PREFIX:/=)/sbin,; s,@BINDIR@,$(SERVICE_PREFIX:/=)/bin,' \
	    board/systemd/$$u@.service >$$f@.service; chmod 644 $$f@.service; done
	install -m 644 $(wildcard $(foreach f,$(FACES),board/systemd/$f@.socket)) board/systemd/owsd.service $(SERVICE_IN)/systemd/system
	install -m 644 board/systemd/sysusers.conf $(SERVICE_IN)/sysusers.d/owsd.conf
	sh board/face-files $(B)/faces
	@set -e; for f in $(FACES); do install -m 644 $(B)/faces/$$f.sysusers $(SERVICE_IN)/sysusers.d/$$f.conf; \
	    [ ! -e $(B)/faces/$$f.service ] || install -m 644 $(B)/faces/$$f.service $(SERVICE_IN)/systemd/system; done
	install -m 644 board/systemd/tmpfiles.conf $(SERVICE_IN)/tmpfiles.d/owsd.conf
	install -m 644 board/systemd/owsd-writer-tmpfiles.conf $(SERVICE_IN)/tmpfiles.d/owsd-writer.conf
	install -m 644 board/systemd/modules-load.conf $(SERVICE_IN)/modules-load.d/owsd.conf
	install -m 644 board/udev/owsd.rules $(SERVICE_IN)/udev/rules.d/60-owsd.rules
	[ -e $(D)/etc/owsd/OWS.rio ] || install -m 644 board/debian/OWS.rio $(D)/etc/owsd/OWS.rio
	@echo 'now: systemd-sysusers; systemd-tmpfiles --create; modprobe i2c-dev; udevadm trigger;'
	@echo '     udevadm trigger --action=add --subsystem-match=w1; systemctl daemon-reload;'
	@echo '     systemctl enable --now owsd      (its configuration: /etc/owsd/OWS.rio)'
	@echo "     and after an upgrade: systemctl try-restart 'owsd*'"
	@echo '     and for the page: owsctl enable web; likewise $(patsubst owsd-%,%,$(filter-out owsd-web owsd-writer,$(FACES))). owsctl doctor says what is wrong'

uninstall-service:
	rm -f $(addprefix $(SERVICE_IN)/,$(SERVICE))

# --- Packages ---------------------------------------------------------------------------------
# One architecture or several, for this Debian or another: ARCH='arm64 armhf' SUITE=trixie
deb:
	@sh board/make-deb $(if $(SUITE),--suite $(SUITE)) $(ARCH)

# build/deb as an apt repository: REPOSITORY_KEY='OLD NEW' REPOSITORY_URL=https://... REPOSITORY=DIR
repository:
	@sh board/install-deps repository
	@sh board/make-repository $(if $(REPOSITORY),--out $(REPOSITORY)) \
	    $(if $(REPOSITORY_URL),--url $(REPOSITORY_URL)) $(REPOSITORY_KEY)

# Of packages for Debian 13, and for this machine's Debian with SUITE=bookworm ARCH=amd64
addon:
	@sh board/make-addon $(if $(SUITE),--suite $(SUITE)) $(if $(ADDON_URL),--url $(ADDON_URL)) $(ARCH)

test-package:
	@sh board/install-deps chroot repository $(if $(OR_SKIP),|| true)
	@sh tests/package/run $(if $(OR_SKIP),--or-skip) $(if $(SUITE),--suite $(SUITE)) $(ARCH)

# build/deb as an image for containers: ARCH='amd64 arm64 armhf' SUITE=trixie
.PHONY: oci recipes
oci:
	@sh board/install-deps oci
	@python3 board/make-oci $(if $(SUITE),--suite $(SUITE)) $(ARCH)

# The two commands of the README in new systems: DEBIAN=bookworm HAVE=gcc AT=tmp ORDER=run-test
test-fresh: export DEBIAN := $(DEBIAN)
test-fresh: export HAVE := $(HAVE)
test-fresh: export AT := $(AT)
test-fresh: export ORDER := $(ORDER)
test-fresh: export TESTS := $(TESTS)
test-fresh:
	@sh board/install-deps chroot $(if $(OR_SKIP),|| true)
	@tests/fresh/run $(if $(OR_SKIP),--or-skip)

# The service under its own systemd in QEMU, with the packages of the last make deb
test-service:
	@sh board/install-deps build kernel chroot
	@$(MAKE) --no-print-directory kernel-programs
	@python3 tests/package/boot $(if $(SUITE),--suite $(SUITE)) $(if $(OR_SKIP),--or-skip) \
	    --debs build/deb --program $(B)/kernel/simchip

# --- Release ----------------------------------------------------------------------------------
dist:
	@sh board/install-deps dist
	@sh board/make-dist

recipes:
	@python3 board/make-recipes $(if $(RECIPES_URL),--url $(RECIPES_URL)) build/dist/owsd-$(VERSION).tar.xz

test-dist: build/unity/unity.h
	@sh board/install-deps build dist
	@sh tests/dist/run

-include $(shell find $(B) -type f -name '*.d' 2>/dev/null)

FORCE:

clean:
	rm -rf $(B)
