# Two commands: `make demo` renders the Cornell box to out/, `make test` checks everything. Both install what the machine
# lacks first (.ci/setup), and cost nothing extra where nothing is missing. They share what they compile: one profile for all.
# `make install PREFIX=/usr/local DESTDIR=` installs the program with its completions, manual pages and scenes; `make uninstall`; `make dist`.

CARGO ?= cargo
export CARGO
# Wherever cargo puts the program (CARGO_TARGET_DIR, build.target-dir).
LUMBRE = $(CARGO) run --release --quiet --

# Finds what docs/metropolis.md says of light that next-event estimation cannot sample: to be run by hand.
KNOWN = the_whole_canon

# What `cargo fmt` does not find by itself, for a macro makes the modules of it.
FAMILIES = src/techniques/*/*.rs

# Where `make install` puts the program; DESTDIR goes before it, for whoever makes packages.
PREFIX ?= /usr/local
DESTDIR ?=
# What is installed, as it lies below the prefix.
PACKAGE = out/package

.PHONY: demo build package install uninstall dist test quick thorough bench lecture soak clean

demo: build
	@mkdir -p out
	$(LUMBRE) render scenes/cornell.xml -o out/cornell.exr -o out/cornell.png

build:
	@.ci/setup build
	$(CARGO) build --release

package: build
	@packaging/stage $(PACKAGE)

# `sudo make install` need not find cargo: what `make package` left is installed then.
install: $(if $(shell command -v $(CARGO)),package)
	@[ -d $(PACKAGE) ] || { echo "error: there is no $(PACKAGE): run make package first, as a user who has cargo" >&2; exit 1; }
	@packaging/install $(PACKAGE) "$(DESTDIR)$(PREFIX)"

uninstall:
	@packaging/install --remove "$(DESTDIR)$(PREFIX)"

# A tarball that needs nothing but the Vulkan loader and a driver: out/dist/.
dist: package
	@packaging/dist $(PACKAGE) out/dist

test:
	@.ci/setup test
	$(CARGO) fmt --check -- $(FAMILIES)
	$(CARGO) clippy --release --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --release --no-deps
	@.ci/tests --no-fail-fast

# What is fast of every room, for the loop of edit and try: the list is in .ci/quick.
quick:
	@.ci/setup test
	@$(CARGO) test --release --quiet --lib
	@.ci/tests --test tests -- $$(sed 's/ *\#.*//' .ci/quick)

# With the tests that take minutes each, which `make test` leaves out, and what other features need, shaders which
# change while the window is open among it: two hours on two cores.
thorough: export LUMBRE_TEST_THOROUGH = 1
thorough:
	@.ci/setup test
	@.ci/tests --no-fail-fast -- --include-ignored --skip $(KNOWN)
	$(CARGO) clippy --release --all-targets --no-default-features -- -D warnings
	$(CARGO) clippy --release --all-targets --features hot-reload -- -D warnings
	@.ci/tests --features hot-reload --test tests -- view::
	@benches/planted_faults.py --check

# Speed against error of four scenes: out/bench/index.html. Under ten minutes on two cores.
bench: build
	$(LUMBRE) bench scenes/cornell.xml scenes/cornell_spheres.xml scenes/veach_mis.xml scenes/gltf_room/room.gltf \
		-i path,path-implicit --backend bvh,ray-query -t 2.5 --seeds 5 --size 128x128 \
		-o out/bench --fresh

# Every comparison of the lecture, measured here: out/lecture/index.html. Goes on where it was interrupted.
lecture: build
	$(LUMBRE) lecture -o out/lecture

# An hour of scenes and settings that chance chooses, with validation on: nothing may stay behind.
soak:
	@.ci/setup test
	LUMBRE_SOAK_SECONDS=$${LUMBRE_SOAK_SECONDS-3600} LUMBRE_TEST_ALONE=soak::nothing_stays_behind \
		.ci/tests --test tests -- soak::nothing_stays_behind --exact --nocapture

clean:
	$(CARGO) clean
	rm -rf out
