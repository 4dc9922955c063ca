#!/bin/sh
# SPDX-License-Identifier: MIT
# make repository: apt takes the packages from its tree over http, by their hashes; it refuses what
# was changed or signed by somebody else; a user goes from an old key to a new one
set -eu

for program in apt-get apt-ftparchive gpg xz; do
	command -v $program >/dev/null || { echo "$program is not here (sh board/install-deps repository)"; exit 77; }
done
GNUPGHOME=$(mktemp -d) # a path that its sockets have room for
export GNUPGHOME
server=''
end() {
	[ -z "$server" ] || kill "$server" 2>/dev/null || true
	gpgconf --kill all
	rm -rf "$GNUPGHOME"
}
trap end EXIT
trap 'exit 130' INT TERM HUP
fail() { echo "$*" && exit 1; }

# deb VERSION ARCHITECTURE: a package of that in debs
deb() {
	mkdir -p package/DEBIAN debs
	printf 'Package: owsd\nVersion: %s\nArchitecture: %s\nMaintainer: x <x@example.org>\nDescription: x\n' \
		"$1" "$2" >package/DEBIAN/control
	dpkg-deb -b --root-owner-group package debs >/dev/null
}
key() {
	gpg --batch -q --passphrase '' --quick-generate-key "$1 <$1@example.org>" ed25519 sign never
	gpg --trust-model always --list-keys --with-colons "$1" | sed -n '/^fpr/{ s/^fpr:*\([^:]*\):.*/\1/p; q; }'
}
python3 -u -c 'import functools, http.server
s = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(http.server.SimpleHTTPRequestHandler, directory="tree"))
print(s.server_port)
s.serve_forever()' >port 2>requests &
server=$!
for _ in $(seq 200); do
	[ ! -s port ] || break
	sleep 0.1 # pace
done
url=http://127.0.0.1:$(cat port)
repository() { sh "$OWSD_SOURCE/board/make-repository" --debs debs --out tree --url "$url" "$@" >said 2>&1; }
made() { repository "$@" || { cat said; fail "no repository with $*"; }; }
# refuses WHY [KEY]
refuses() {
	why=$1
	shift
	! repository "$@" || fail "it takes: $why"
	grep -q "$why" said || { cat said; fail "it does not say: $why"; }
}

# user SUITE: a new machine's apt, which knows of nothing but what SUITE.sources has
user() {
	rm -rf machine && mkdir -p machine/lists/partial machine/cache/archives/partial machine/etc
	: >machine/status
	cp "tree/$1.sources" machine/etc/owsd.sources
}
apt() {
	apt-get -q -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$PWD/machine/etc" \
		-o Dir::State::Lists="$PWD/machine/lists" -o Dir::Cache="$PWD/machine/cache" \
		-o Dir::State::status="$PWD/machine/status" -o APT::Sandbox::User= -o APT::Architecture=amd64 \
		-o APT::Architectures::=amd64 -o Acquire::Languages=none -o Acquire::http::Proxy=DIRECT \
		-o APT::Update::Post-Invoke-Success::= -o APT::Update::Post-Invoke::= -o APT::Update::Error-Mode=any "$@" >apt.log 2>&1
}
# gets VERSION WHAT: this is the newest that the machine is offered, whole
gets() {
	apt update || { cat apt.log; fail "no update: $2"; }
	rm -f owsd_*.deb
	apt download owsd || { cat apt.log; fail "no package: $2"; }
	[ "$(echo owsd_*.deb)" = "owsd_$1_amd64.deb" ] || fail "$2: $(echo owsd_*.deb) in place of $1"
}
# denied WHY WHAT [COMMAND...]: apt does not do it (update), and says why
denied() {
	why=$1 what=$2
	shift 2
	! apt "${@:-update}" || fail "apt takes $what"
	grep -q -i "$why" apt.log || { cat apt.log; fail "$what is refused for another reason than: $why"; }
}

old=$(key old)
new=$(key new)
stranger=$(key stranger)

refuses 'no package is in debs' "$old"
deb 1.0+deb12 amd64
refuses 'no key signs it'
refuses 'gpg has no secret key 0123' 0123
deb 1.0 amd64
refuses 'owsd_1.0_amd64.deb is of no suite' "$old"
[ ! -e tree/pool ] || fail 'a set that was refused changed the tree'
rm debs/owsd_1.0_amd64.deb

deb 2.0+deb13 amd64
deb 2.0+deb13 arm64
made "$old"
user bookworm
gets 1.0+deb12 'the package of bookworm'
grep -q '/main/binary-amd64/by-hash/SHA256/' requests || fail 'apt did not ask by hash'
ls tree/dists/bookworm/main/binary-amd64/by-hash/SHA256 >first
grep -q '^Architectures: amd64 arm64$' tree/dists/trixie/Release || fail 'the architectures of trixie'
user trixie
gets 2.0+deb13 'the package of trixie'

# The next release. What was named before is there for whoever is reading it
user bookworm
gets 1.0+deb12 'before the next'
rm -r debs
deb 1.1+deb12 amd64
made "$old"
gets 1.1+deb12 'the next release'
[ -e tree/pool/bookworm/owsd_1.0+deb12_amd64.deb ] || fail 'the older package is gone'
ls tree/dists/bookworm/main/binary-amd64/by-hash/SHA256 >second
[ "$(sort first second | uniq -d | wc -l)" = 2 ] || fail 'the older index is gone'
find tree/dists -path '*/by-hash/*' -exec touch -d '31 days ago' {} +
made "$old"
made "$old"
(cd tree/dists/bookworm/main/binary-amd64 && [ "$(find by-hash -type f | wc -l)" = 2 ]) || fail 'old indexes stay for ever'
echo other >package/other
deb 1.1+deb12 amd64
refuses 'with other bytes' "$old"

cp -r tree older

# From the old key to the new one
rm -r debs package/other
deb 1.2+deb12 amd64
mkdir bin
cat >bin/cp <<'END'
#!/bin/sh
case $* in *tree/pool/*) head -c 100 "$1" >"$2" && exit 1 ;; esac
exec /bin/cp "$@"
END
chmod 755 bin/cp
! PATH="$PWD/bin:$PATH" repository "$old" || fail 'a disk that is full is no error'
made "$old" "$new"
gets 1.2+deb12 'with the old key, of both'
user bookworm
gets 1.2+deb12 'with both'
sed -i '/^Signed-By/,$d' machine/etc/owsd.sources
{ echo Signed-By: && gpg --armor --export "$new" | sed 's/^$/./; s/^/ /'; } >>machine/etc/owsd.sources
gets 1.2+deb12 'with the new key, of both'
user bookworm
rm -r debs
deb 1.3+deb12 amd64
made "$new"
gets 1.3+deb12 'with both, of the new one'

# What somebody else has made
cp -r tree whole
made "$stranger"
denied verif 'what a stranger signs'
rm -rf tree && cp -r whole tree
sed -i 's/^Date: .*/Date: Fri, 01 Jan 2100 00:00:00 +0000/' tree/dists/bookworm/Release tree/dists/bookworm/InRelease
denied 'signature' 'a changed InRelease'
rm -rf tree && cp -r whole tree
rm -rf machine/lists/*.* machine/lists/partial/*
find tree/dists -name 'Packages*' -delete
for file in tree/dists/bookworm/main/*/by-hash/SHA256/*; do
	printf x | dd of="$file" bs=1 seek=100 conv=notrunc 2>/dev/null
done
denied 'hash sum mismatch' 'a changed index'
rm -rf tree && cp -r whole tree
gets 1.3+deb12 'the whole one again'
rm -rf machine/cache && mkdir -p machine/cache/archives/partial
printf x | dd of=tree/pool/bookworm/owsd_1.3+deb12_amd64.deb bs=1 seek=100 conv=notrunc 2>/dev/null
rm owsd_*.deb
denied 'hash sum mismatch' 'a changed package' download owsd

# A mirror that shows an older tree: who has seen the newer one keeps that
rm -rf tree && cp -r whole tree
gets 1.3+deb12 'before the older one'
rm -rf tree && cp -r older tree
rm -f owsd_*.deb
apt update || true
apt download --print-uris owsd || { cat apt.log; fail 'no address after the older tree'; }
grep -q 'owsd_1.3.*deb12_amd64.deb' apt.log || { cat apt.log; fail 'an older tree is taken'; }
user bookworm
gets 1.1+deb12 'a new machine, which knows no newer one'
! grep -r Valid-Until tree/dists || fail 'a tree that stands still has an end'
made --valid 1 "$new"
grep -q "^Valid-Until: $(LC_ALL=C date -u -d 'tomorrow' '+%a, %d %b %Y')" tree/dists/bookworm/Release || fail 'no end after a day'
