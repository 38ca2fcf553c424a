# Two commands: `make demo` renders the Cornell box to out/, `make test` checks everything. Both install what the machine
# lacks first (.ci/setup), and cost nothing extra where nothing is missing.

CARGO ?= cargo
LUMBRE = target/release/lumbre

# The tests run on lavapipe, on every machine alike: on it both backends must be there.
export LUMBRE_TEST_DEVICE ?= llvmpipe
export LUMBRE_TEST_BACKENDS ?= all

# Where set-up has brought Chromium, the test of the report must find it.
BROWSER = LUMBRE_TEST_CHROMIUM=$${LUMBRE_TEST_CHROMIUM-$$(.ci/setup browser)}

# Finds what docs/metropolis.md says of light that only chance finds: to be run by hand.
KNOWN = the_whole_canon

# All tests: beside each other, each in a process of its own, where cargo-nextest is there. Compiling a kernel takes one core alone.
HAS_NEXTEST = $(CARGO) nextest --version >/dev/null 2>&1
TESTS = if $(HAS_NEXTEST); \
	then $(BROWSER) $(CARGO) nextest run $(if $(IGNORED),--run-ignored all -E 'not test($(KNOWN))') && $(CARGO) test --doc; \
	else $(BROWSER) $(CARGO) test $(if $(IGNORED),-- --include-ignored --skip $(KNOWN)); fi

.PHONY: demo build test quick thorough bench lecture soak clean

demo: build
	@mkdir -p out
	$(LUMBRE) render scenes/cornell.xml -o out/cornell.exr -o out/cornell.png

build:
	@.ci/setup build
	$(CARGO) build --release

test:
	@.ci/setup test
	$(CARGO) fmt --check
	$(CARGO) clippy --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --no-deps
	@$(TESTS)

# The tests alone, for the loop of edit and try.
quick:
	@.ci/setup test
	@$(TESTS)

# With the tests that take minutes each, which `make test` leaves out: two hours on two cores.
thorough: IGNORED = yes
thorough: export LUMBRE_TEST_THOROUGH = 1
thorough:
	@.ci/setup test
	@$(TESTS)

# Speed against error of four scenes: out/bench/index.html. Under ten minutes on two cores.
bench: build
	$(LUMBRE) bench scenes/cornell.xml scenes/cornell_spheres.xml scenes/veach_mis.xml scenes/gltf_room/room.gltf \
		-i path,path-implicit --backend bvh,ray-query -t 2.5 --seeds 5 --size 128x128 --reference-spp 2048 \
		-o out/bench --fresh

# Every comparison of the lecture, measured here: out/lecture/index.html. Goes on where it was interrupted.
lecture: build
	$(LUMBRE) lecture -o out/lecture

# An hour of scenes and settings that chance chooses, with validation on: nothing may stay behind.
soak:
	@.ci/setup test
	LUMBRE_SOAK_SECONDS=$${LUMBRE_SOAK_SECONDS-3600} $(CARGO) test --test soak -- --nocapture

clean:
	$(CARGO) clean
	rm -rf out
