#!/usr/bin/env bash
# program_test.sh ABN SOURCE  calls the program as demanding and as hostile users do: every example of its help and of the README, wrong
# words, damaged files, full disks, stopped and resumed experiments. Names every failed check on stderr; exit code 0 = none.
# Needs: coreutils, grep, sed, awk, mount (for the full disk, and only as root).
set -u -o pipefail
if (($# != 2)); then
  echo "usage: program_test.sh PATH_OF_ABN SOURCE_TREE" >&2
  exit 2
fi
abn=$(readlink -f "$1")
root=$(readlink -f "$2")
[[ -x $abn && -d $root/experiments ]] || { echo "program_test.sh: no program '$1', or no source tree '$2'" >&2; exit 2; }
export LC_ALL=C
export GOMP_SPINCOUNT=1000 # threads that wait sleep soon: the tests share the cores
unset ABN_DATA OMP_NUM_THREADS OMP_WAIT_POLICY

work=$(mktemp -d)
cleanup() {
  # shellcheck disable=SC2046
  kill $(jobs -p) 2>/dev/null
  wait
  mountpoint -q "$work/full" 2>/dev/null && umount "$work/full"
  rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 130' INT TERM
export XDG_CACHE_HOME=$work/cache # what is kept between runs goes with the test
failures=$work/failures
: >"$failures"

# --- How a check is made -------------------------------------------------------------------------------------------------------------

fail() { printf 'FAILED: %s\n' "$*" >>"$failures"; }

# The checks that need nothing from each other run three at a time.
spawn() {
  while (($(jobs -rp | wc -l) >= 3)); do wait -n; done
  "$@" &
}

# succeeds OUT ARGUMENTS…: exit code 0; stdout goes to the file OUT.
succeeds() {
  local out=$1 code=0
  shift
  "$abn" "$@" >"$out" 2>"$out.err" </dev/null || code=$?
  ((code == 0)) || fail "abn $*: exit code $code instead of 0: $(head -n 3 "$out.err")"
  return "$code"
}

# refused CODE PATTERN ARGUMENTS…: that exit code, one line on stderr that matches, nothing on stdout, no file left behind. Runs in an
# empty folder of its own.
refused() (
  want=$1 pattern=$2 code=0
  shift 2
  here=$(mktemp -d "$work/refused.XXXXXX")
  mkdir "$here/cwd" && cd "$here/cwd" || exit
  "$abn" "$@" >"$here/out" 2>"$here/err" </dev/null || code=$?
  call="abn $*"
  ((code == want)) || fail "$call: exit code $code instead of $want ($(head -n 1 "$here/err"))"
  (($(wc -l <"$here/err") == 1)) || fail "$call: $(wc -l <"$here/err") lines on stderr instead of one: $(cat "$here/err")"
  grep -q '^abn: ' "$here/err" && grep -qE -- "$pattern" "$here/err" || fail "$call: the message does not say /$pattern/: $(cat "$here/err")"
  [[ ! -s $here/out ]] || fail "$call: failed, yet printed on stdout: $(head -c 200 "$here/out")"
  [[ -z $(ls -A .) ]] || fail "$call: left behind $(ls -A .)"
)

# json_with FILE KEY…: exactly one JSON object on one line, with these keys.
json_with() {
  local file=$1 key
  shift
  (($(wc -l <"$file") == 1)) || fail "$file: not one line of JSON but $(wc -l <"$file")"
  # Without its strings the line must open and close its brackets in pairs, and be one object.
  sed 's/\\.//g; s/"[^"]*"//g' "$file" | awk '
    { depth = 0; n = length($0); ends = 0
      for (i = 1; i <= n; ++i) { c = substr($0, i, 1); if (c ~ /[{[]/) ++depth; if (c ~ /[]}]/) { --depth; if (depth == 0) ++ends } }
      if (substr($0, 1, 1) != "{" || substr($0, n, 1) != "}" || depth != 0 || ends != 1) exit 1 }' ||
    fail "$(basename "$file"): not one JSON object: $(head -c 300 "$file")"
  for key; do grep -q "\"$key\":" "$file" || fail "$(basename "$file"): the JSON lacks the key $key: $(head -c 300 "$file")"; done
}

number() { grep -oE "\"$2\":-?[0-9.e+-]+" "$1" | head -n 1 | cut -d: -f2; } # number FILE KEY
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 < b + 0) }'; }
began=$EPOCHREALTIME

# Files that several checks read.
in=$work/in
mkdir -p "$in/folder.png" "$work/bin"
ln -s "$abn" "$work/bin/abn"
cat >"$work/bin/my_sampler" <<'SAMPLER'
#!/bin/sh
awk -v n="$1" -v seed="$2" 'BEGIN { srand(seed); for (i = 0; i < n; ++i) print rand(), rand() }'
SAMPLER
chmod +x "$work/bin/my_sampler"
for format in png jpg exr; do "$abn" scene disks --size 300 -o "$in/disks.$format" --quiet || fail "abn scene disks -o disks.$format"; done
{ printf 'Pf\n2 2\n-1.0\n' && printf '\0\0\200\077\0\0\300\177\0\0\200\177\0\0\200\377'; } >"$in/nan.pfm" # from below: 1 NaN, Inf -Inf
cat >"$in/many.toml" <<'TOML'
name = "many"
scenes = ["scene:ramp"]
to = "8x8"
spp = 1
seeds = 500
metrics = ["rmse"]
[[strategy]]
name = "jitter"
TOML

# Before all else, while nothing of this test wants the cores.
list_is_quick() {
  local fastest=99 seconds kind TIMEFORMAT=%R
  for kind in strategies scenes metrics; do
    seconds=$({ time "$abn" list $kind >"$work/list"; } 2>&1)
    [[ -s $work/list ]] || fail "abn list $kind prints nothing"
    below "$seconds" "$fastest" && fastest=$seconds
  done
  echo "abn list: $fastest s"
  below "$fastest" 1 || fail "abn list takes $fastest s"
}

# Every example of the help and of the README runs.
examples() {
  local verb verbs file example command
  mkdir "$work/examples" && cd "$work/examples" || exit
  succeeds "$work/version" --version
  grep -qE '^abn [0-9]+\.[0-9]+\.[0-9]+ \(.+\)$' "$work/version" || fail "--version prints '$(cat "$work/version")'"
  succeeds "$work/help" --help
  grep -E '^  abn ' "$work/help" >"$work/lines" || fail "--help has no example"
  verbs=$(sed -n '/^Subcommands:/,/^$/p' "$work/help" | awk '/^  [a-z]/ { print $1 }')
  for verb in downscale run points analyze compare truth scene list info; do grep -qw "$verb" <<<"$verbs" || fail "--help does not name $verb"; done
  # In this order each example finds the files of those before.
  for verb in downscale truth compare $(grep -vwE 'downscale|truth|compare' <<<"$verbs"); do
    succeeds "$work/help.$verb" "$verb" --help
    sed -n '/^Example:/,$p' "$work/help.$verb" | grep -E '^  abn ' >>"$work/lines" || fail "abn $verb --help has no example"
  done
  if [[ -f $root/README.md ]]; then
    grep -E '^abn ' "$root/README.md" | sed 's/   .*//' >>"$work/lines"
    ln -s "$in/disks.jpg" photo.jpg # the reader's own files
    succeeds o truth scene:zone_plate --integrand bilinear -o mine.exr
  fi
  while read -r example; do
    # A whole experiment of minutes is only planned here; temporary files go to this test's folder.
    command=${example//\/tmp\//$work/examples/}
    [[ $command =~ ^abn\ run\ (main|fig_3_3) ]] && command+=" --dry-run"
    PATH=$work/bin:$PATH bash -c "$command" >o 2>o.err </dev/null || fail "example '$example': exit code $?: $(tail -n 1 o.err)"
  done < <(awk '{ sub(/^ +/, ""); sub(/ +$/, "") } !seen[$0]++' "$work/lines")
  for file in apple.exr apple_error.png truth.exr error.png points.txt zone.png fig_3_2/runs.csv; do
    [[ -s $file ]] || fail "the examples of the help did not write $file"
  done
}

# Wrong words and damaged files are refused.
refusals() {
  mkdir "$in/exists"
  : >"$in/zero.png"
  echo "this is text" >"$in/text.png"
  head -c 100000 "$root/reference_images/apple.png" >"$in/cut.png"
  head -c 5000 "$in/disks.jpg" >"$in/cut.jpg"
  head -c 20000 "$in/disks.exr" >"$in/cut.exr"
  printf '0.5 0.5\n0.25 0.75\n' >"$in/two.txt"
  local seed file flag ramp jitter d
  d=(downscale scene:ramp --to 8x8 --strategy jitter)

  spawn refused 2 "no verb 'nonsense'.*downscale" nonsense
  spawn refused 2 '\-\-nonsense.*abn list --help' list --nonsense
  spawn refused 2 "'nonsense'.*known:.*jitter" list strategies nonsense
  spawn refused 2 '\-\-strategy.*missing' downscale scene:ramp --strategy
  spawn refused 2 "strategy 'nonsense'; known: random" downscale scene:ramp --strategy nonsense
  spawn refused 2 "scene 'nonsense'.*known" downscale scene:nonsense --strategy jitter
  spawn refused 2 "\-\-spp is 'nan'; give" "${d[@]}" --spp nan
  spawn refused 2 '\-\-spp: the value is empty' "${d[@]}" --spp ''
  spawn refused 2 'gives 1.*not whole; give --samples 1' "${d[@]}" --spp 0.02
  spawn refused 2 "\-\-samples: '68719476737' is no whole number from 1 to" "${d[@]}" --samples 68719476737
  spawn refused 2 '\-\-spp excludes --samples' "${d[@]}" --samples 64 --spp 1
  for seed in -1 18446744073709551616; do spawn refused 2 "\-\-seed: '$seed' is no whole number" "${d[@]}" --seed "$seed"; done
  spawn refused 2 "\-\-to is '0x5'; give WIDTHxHEIGHT" downscale scene:ramp --strategy jitter --to 0x5
  spawn refused 2 "unknown parameter 'nonsense'" "${d[@]}" --set nonsense=1
  spawn refused 2 "'iterations'.*'abc'.*give" downscale scene:ramp --strategy sph_blue_noise --set iterations=abc
  spawn refused 2 'nearest budgets are 6 and 8' downscale scene:apple_analytic --strategy regular --samples 7 # before the slow scene
  spawn refused 2 'give exact, or monte_carlo' "${d[@]}" --truth monte_carlo:0
  spawn refused 2 '\-\-channels R: scene:ramp' "${d[@]}" --channels R
  spawn refused 4 'cuda.*use --backend cpu' "${d[@]}" --backend cuda
  spawn refused 2 'extension.*known: .exr' "${d[@]}" -o x.nonsense
  spawn refused 2 '\-\-output: the value is empty' "${d[@]}" -o ''
  spawn refused 2 'name the same file' "${d[@]}" -o x.png --error-map ./x.png
  spawn refused 2 'name the same file' "${d[@]}" --reconstruction kriging --reliability x.png --points-picture ./x.png
  spawn refused 2 "\-\-target-error: '0' is no number > 0" "${d[@]}" --target-error 0
  spawn refused 2 '\-\-target-error with jitter.*use one of.*sph_adaptive' "${d[@]}" --target-error 0.1
  spawn refused 2 '\-\-target-error: the reconstruction voronoi estimates no errors.*kriging' downscale scene:ramp --strategy sph_adaptive --reconstruction voronoi --target-error 0.1
  spawn refused 2 '\-\-estimated-error: the reconstruction voronoi estimates no errors.*kriging' "${d[@]}" --reconstruction voronoi --estimated-error x.png
  spawn refused 2 '\-\-reliability: the reconstruction voronoi estimates no errors' "${d[@]}" --reconstruction voronoi --reliability x.csv
  spawn refused 2 '\-\-reliability x.exr: .*8-bit picture' "${d[@]}" --reconstruction kriging --reliability x.exr
  spawn refused 2 '\-\-points-picture x.exr: .*8-bit picture' "${d[@]}" --points-picture x.exr
  spawn refused 2 'extension.*known: .exr' "${d[@]}" --reconstruction kriging --estimated-error x.nonsense
  spawn refused 2 "\-\-points-region is '1,2'; give LEFT,TOP,RIGHT,BOTTOM" "${d[@]}" --points-picture x.png --points-region 1,2
  spawn refused 2 "\-\-points-region is '9,0,12,4'.*8x8 plane" "${d[@]}" --points-picture x.png --points-region 9,0,12,4
  spawn refused 2 '\-\-points-region requires --points-picture' "${d[@]}" --points-region 0,0,4,4
  spawn refused 2 'jitter as it is set looks at no guide.*sph_adaptive --set driver=guide' "${d[@]}" --guide true_variance
  spawn refused 2 'sph_adaptive as it is set looks at no guide' downscale scene:ramp --strategy sph_adaptive --guide true_variance
  spawn refused 2 'give --guide' downscale scene:ramp --strategy sph_adaptive --set driver=guide
  spawn refused 3 "cannot read image '$in/missing.png'" downscale scene:ramp --strategy sph_adaptive --set driver=guide --guide "$in/missing.png"
  for flag in --estimated-error --reliability --points-picture; do
    spawn refused 3 "nowhere/x.png'.*create the folder" "${d[@]}" --reconstruction kriging $flag nowhere/x.png
    spawn refused 3 'not a folder' "${d[@]}" --reconstruction kriging $flag "$in/folder.png"
  done
  spawn refused 3 "nowhere/x.csv'.*create the folder" "${d[@]}" --reconstruction kriging --reliability nowhere/x.csv
  spawn refused 3 "nowhere/x.png'.*create the folder" "${d[@]}" -o nowhere/x.png
  spawn refused 3 "nowhere/x.csv'.*create the folder" "${d[@]}" --points nowhere/x.csv
  spawn refused 3 'not a folder' "${d[@]}" -o "$in/folder.png"
  spawn refused 3 'disk is full' "${d[@]}" --points /dev/full
  for file in missing.png zero.png text.png cut.png cut.jpg cut.exr; do
    spawn refused 3 "cannot read image '$in/$file': .+; " downscale "$in/$file" --to 8x8 --strategy jitter
  done
  spawn refused 3 '3 values are NaN or infinite, the first at \(0, 0\).*--on-nonfinite zero' downscale "$in/nan.pfm" --strategy jitter --to 2x2
  spawn refused 3 "'a\?b.png'" downscale $'a\nb.png' --strategy jitter
  spawn refused 2 'holds 2 points, but 3' downscale scene:ramp --strategy "file:$in/two.txt" --samples 3
  spawn refused 3 'no such file' downscale scene:ramp --strategy file:nowhere.txt --samples 3
  spawn refused 3 'exit status 7; the last line.*why' downscale scene:ramp --strategy 'command:echo why >&2; exit 7'
  spawn refused 2 'a file of points, or a strategy' analyze
  spawn refused 2 'not both' analyze "$in/two.txt" --strategy jitter
  spawn refused 2 'leave out --count' analyze "$in/two.txt" --count 5
  spawn refused 2 "strategy 'nonsense'.*jitter" analyze --strategy nonsense
  spawn refused 2 "unknown parameter 'nonsense'" analyze --strategy halton --set nonsense=1
  spawn refused 2 "size field 'nonsense'.*smooth" analyze --strategy jitter --density size:nonsense
  spawn refused 2 "'2' is no number from 0 to 1" analyze --strategy jitter --density size:ramp --density-floor 2
  spawn refused 2 'pixels.*200x200' analyze --strategy jitter --pixels many
  spawn refused 3 "nowhere.txt.*no such file" analyze nowhere.txt
  spawn refused 3 'this is no folder' analyze --strategy jitter -o "$in/two.txt"
  spawn refused 2 'Known formats|extension|format' points --strategy jitter --count 5 -o x.txt --picture x.nonsense
  spawn refused 3 'create the folder' points --strategy dart --count 2000000 -o nowhere/x.txt # before the slow work
  spawn refused 2 "metric 'nonsense'.*known" compare "$in/text.png" "$in/text.png" --metric nonsense
  spawn refused 3 "no experiment 'nonsense'; known:.*main" run nonsense
  spawn refused 2 'I/N' run main --shard 2/2 --dry-run
  spawn refused 2 "no strategy 'nonsense'; it has: random_pixel" run main --set nonsense.x=1 --dry-run
  spawn refused 2 'folder exists; go on with --resume' run main --out "$in/exists"
  spawn refused 3 'this is no folder' run main --out "$in/two.txt"
  spawn refused 3 '/proc/x: cannot be made' run main --out /proc/x
  touch "$in/exists/kept"
  spawn refused 2 'no runs.jsonl' run main --out "$in/exists" --overwrite
  # Experiments with one mistake each: message, then the lines in place of the good ones.
  bad_spec() {
    local name=$1 pattern=$2 code=$3
    shift 3
    printf '%s\n' "$@" >"$in/$name.toml"
    spawn refused "$code" "$pattern" run "$in/$name.toml" --dry-run
  }
  ramp='scenes = ["scene:ramp"]' spp='spp = 1' jitter=$'[[strategy]]\nname = "jitter"'
  bad_spec syntax 'syntax.toml:1: not valid TOML' 2 'scenes = ['
  bad_spec unknown_key "unknown_key.toml:3: unknown key 'nonsense'.*known:" 2 "$ramp" "$spp" 'nonsense = 3' "$jitter"
  bad_spec same_budget 'lists 40000 twice' 2 "$ramp" 'spp = [1, 1]' "$jitter"
  bad_spec crop_who "'crops' names 'nonsense'.*known: none" 2 "$ramp" "$spp" 'crops = ["nonsense"]' "$jitter"
  bad_spec crop_known "'crops' names 'nonsense'.*known: .*stalk" 2 'scenes = ["scene:apple"]' "$spp" 'crops = ["nonsense"]' "$jitter"
  bad_spec crop_size "'zoom' is 101" 2 "$ramp" "$spp" 'zoom = 101' "$jitter"
  bad_spec sample_pictures 'sample_pictures = true without images' 2 "$ramp" "$spp" 'sample_pictures = true' "$jitter"
  bad_spec target '\-\-target-error with jitter' 2 "$ramp" "$spp" 'target_error = 0.1' "$jitter"
  points='kind = "points"' counts='counts = 16'
  bad_spec other_kind "'kind' must be \"images\" or \"points\"" 2 'kind = "nonsense"' "$counts" "$jitter"
  bad_spec no_counts 'no counts; add counts = ' 2 "$points" "$jitter"
  bad_spec point_metric "metric 'rmse' of point sets is unknown; known metrics: .*relative_radius" 2 "$points" "$counts" 'metrics = ["rmse"]' "$jitter"
  bad_spec sweep_who "no strategy 'halton'; it has: jitter" 2 "$points" "$counts" "$jitter" $'[sweep]\nhalton.scramble = ["owen", "none"]'
  bad_spec sweep_how "'sweep' must hold lines such as" 2 "$points" "$counts" "$jitter" $'[sweep]\njitter = 3'
  bad_spec same_sets 'are the same sets' 2 "$points" "$counts" "$jitter" "$jitter"$'\nlabel = "again"'
  bad_spec point_density "scene 'nonsense' is unknown" 2 "$points" "$counts" 'density = "scene:nonsense"' "$jitter"
  bad_spec no_image "nowhere.png': there is no such file" 3 'scenes = ["nowhere.png"]' "$spp" "$jitter"
  wait
  [[ $(ls "$in/exists") == kept ]] || fail "run --overwrite touched a folder that is no experiment: $(ls "$in/exists")"
}

# Output that cannot be written leaves nothing half-written.
full_disks() {
  mkdir "$work/disks" && cd "$work/disks" || exit
  local call code
  for call in list "downscale scene:ramp --to 8x8 --strategy jitter --json"; do
    code=0
    # shellcheck disable=SC2086
    "$abn" $call >/dev/full 2>o.err || code=$?
    ((code == 3 && $(wc -l <o.err) == 1)) || fail "abn $call >/dev/full: exit code $code instead of 3, or not one line: $(cat o.err)"
  done
  mkdir "$work/full"
  if ((EUID == 0)) && mount -t tmpfs -o size=32k tmpfs "$work/full" 2>/dev/null; then
    on_full_disk() {
      local code=0 left
      "$abn" "$@" >o 2>o.err </dev/null || code=$?
      ((code == 3 && $(wc -l <o.err) == 1)) && grep -q 'disk is full' o.err ||
        fail "abn $* on a full disk: exit code $code instead of 3, or not one line: $(cat o.err)"
      left=$(find "$work/full" -mindepth 1 ! -path "*/runs*")
      [[ -z $left ]] || fail "abn $* on a full disk: left behind $left"
    }
    on_full_disk downscale scene:disks --to 150x150 --strategy jitter -o "$work/full/x.exr"
    on_full_disk scene disks --size 500 -o "$work/full/x.png"
    on_full_disk points --strategy jitter --count 5000 -o "$work/full/x.csv"
    on_full_disk run "$in/many.toml" --out "$work/full/runs"
    [[ $(tail -c 1 "$work/full/runs/runs.jsonl") == "" ]] || fail "a full disk left a cut-off row in runs.jsonl"
    (($(wc -l <"$work/full/runs/runs.jsonl") + 1 == $(wc -l <"$work/full/runs/runs.csv"))) || fail "a full disk left runs.jsonl and runs.csv with different rows"
    umount "$work/full"
  else
    echo "skipped: a full disk needs root and the right to mount"
  fi
}

# What downscale, truth and compare print and write.
pictures() {
  mkdir "$work/pictures" && cd "$work/pictures" || exit
  keys=(strategy scene width height seed samples spp filter reconstruction backend threads params scores rmse mae psnr bias relmse smape
    ssim flip time generate_s evaluate_s reconstruct_s total_s passes empty_pixels max_samples_per_pixel diagnostics)
  downscaled() { # NAME SAMPLES ARGUMENTS…: works, prints the keys of the specification, and takes exactly that many samples
    local name=$1 samples=$2
    shift 2
    succeeds "$name.json" downscale "$@" --json || return
    json_with "$name.json" "${keys[@]}"
    [[ $(number "$name.json" samples) == "$samples" ]] || fail "abn downscale $*: $(number "$name.json" samples) samples instead of $samples"
  }
  for format in png jpg exr; do
    spawn downscaled "$format" 2400 "$in/disks.$format" --to 20x20 --strategy multijitter -o "out_$format.png" --error-map "map_$format.exr"
  done
  spawn downscaled hdr 2400 "$root/reference_images/cornell.exr" --to 20x20 --strategy sobol_owen -o hdr.png --error-map map.png
  spawn downscaled fraction 100 scene:ramp --to 20x20 --strategy sobol --spp 0.25
  spawn downscaled one 1 scene:ramp --to 20x20 --strategy sph_blue_noise --samples 1
  spawn downscaled pixel 6 scene:ramp --to 1x1 --strategy pmj02 --seed 18446744073709551615
  spawn downscaled column 600 "$in/disks.png" --to 1x100 --strategy cmj
  spawn downscaled up 179998 "$in/disks.png" --to 301x299 --strategy jitter --spp 2
  spawn downscaled zeroed 24 "$in/nan.pfm" --to 2x2 --strategy jitter --on-nonfinite zero
  spawn downscaled command 400 scene:ramp --to 10x10 --strategy "command:$work/bin/my_sampler {n} {seed}" --samples 400
  wait
  # What is said of the error without the truth.
  spawn downscaled estimated 2400 "$in/disks.png" --to 20x20 --strategy jitter --reconstruction kriging --error-map true.exr \
    --estimated-error estimated.exr --reliability reliability.csv --points-picture dots.png --points-region -1,-1,5,5
  spawn downscaled drawn 2400 "$in/disks.png" --to 20x20 --strategy jitter --reconstruction kriging --estimated-error estimated.png \
    --reliability reliability.png --points-picture plane.png
  spawn downscaled guided 2400 "$in/disks.png" --to 20x20 --strategy sph_adaptive --set driver=guide --guide "$in/disks.jpg" -o guided.exr
  spawn downscaled unguided 2400 "$in/disks.png" --to 20x20 --strategy sph_adaptive --no-cache -o uncached.exr
  wait
  json_with estimated.json estimated_rmse calibration rmse_ratio worst_bin_factor
  [[ $(number estimated.json estimated_rmse) != "" ]] || fail "downscale --reconstruction kriging estimates no RMSE"
  awk -v a="$(number estimated.json rmse_ratio)" 'BEGIN { exit !(a > 0.3 && a < 3) }' || fail "downscale: estimated / true RMSE is $(number estimated.json rmse_ratio)"
  [[ $(wc -l <reliability.csv) == 21 ]] || fail "downscale --reliability .csv wrote $(wc -l <reliability.csv) lines instead of 21"
  grep -q '"estimated_rmse":[0-9]' png.json || fail "downscale: a mean has no estimated RMSE: $(grep -o '"estimated_rmse":[^,]*' png.json)"
  for file in true.exr estimated.exr dots.png estimated.png reliability.png plane.png; do [[ -s $file ]] || fail "downscale did not write $file"; done
  grep -q '"guide":' guided.json || fail "downscale --guide: its JSON does not name the guide"
  "$abn" downscale "$in/disks.png" --to 20x20 --strategy sph_adaptive --quiet -o cached.exr >/dev/null 2>&1
  cmp -s cached.exr uncached.exr || fail "downscale --no-cache gives another picture"
  succeeds estimated.txt downscale "$in/disks.png" --to 20x20 --strategy jitter --reconstruction kriging
  grep -q 'estimated RMSE .* the true one is 0\.' estimated.txt || fail "downscale prints no estimated RMSE: $(cat estimated.txt)"
  # It stops where the error is small enough, or at the end of the budget with a warning.
  succeeds target.json downscale scene:disks --to 30x30 --strategy sph_adaptive --target-error 0.05 --json
  json_with target.json target_error budget estimated_rmse
  [[ $(number target.json budget) == 57600 ]] || fail "downscale --target-error: the budget is $(number target.json budget) instead of 64 per pixel"
  below "$(number target.json samples)" 57600 || fail "downscale --target-error 0.05 took its whole budget"
  below "$(number target.json estimated_rmse)" 0.0500001 || fail "downscale --target-error 0.05 stopped at $(number target.json estimated_rmse)"
  succeeds missed.json downscale scene:disks --to 20x20 --strategy sph_adaptive --target-error 1e-9 --spp 6 --json
  [[ $(number missed.json samples) == 2400 ]] || fail "downscale --target-error 1e-9: $(number missed.json samples) samples instead of all 2400"
  grep -q 'above --target-error' missed.json.err || fail "downscale --target-error 1e-9: no warning that it was missed: $(cat missed.json.err)"
  for file in out_png.png out_jpg.png out_exr.png map_png.exr hdr.png map.png; do [[ -s $file ]] || fail "downscale did not write $file"; done
  grep -q '"seed":18446744073709551615' pixel.json || fail "the largest seed is not kept: $(grep -o '"seed":[^,]*' pixel.json)"
  for file in png exr; do below "$(number "$file.json" rmse)" 0.2 || fail "downscale of a .$file image: RMSE $(number "$file.json" rmse)"; done
  # The same pictures for any number of threads.
  same_for_any_threads() {
    "$abn" downscale scene:zone_plate --to 40x40 --strategy "$1" --threads 1 --quiet -o "t1_$1.exr" >/dev/null 2>&1
    "$abn" downscale scene:zone_plate --to 40x40 --strategy "$1" --threads 2 --quiet -o "t2_$1.exr" >/dev/null 2>&1
    cmp -s "t1_$1.exr" "t2_$1.exr" || fail "strategy $1: another picture with two threads than with one"
  }
  for strategy in poisson_disk sph_blue_noise; do spawn same_for_any_threads "$strategy"; done
  wait
  succeeds exact.json truth scene:disks --to 40x40 -o exact.exr --json && json_with exact.json width height hash method
  succeeds monte.json truth scene:disks --to 40x40 --truth monte_carlo:100 -o monte.exr --json && json_with monte.json standard_error_rms
  succeeds compare.json compare monte.exr exact.exr --json && json_with compare.json test reference scores rmse flip worst x y channel
  awk -v a="$(number compare.json rmse)" -v b="$(number monte.json standard_error_rms)" 'BEGIN { exit !(a > 0.8 * b && a < 1.2 * b) }' ||
    fail "Monte Carlo truth: RMSE $(number compare.json rmse) against the exact one, but a standard error of $(number monte.json standard_error_rms)"
  succeeds o compare --metric rmse,flip monte.exr exact.exr --fail 0.5
  code=0
  "$abn" compare monte.exr exact.exr --fail 1e-9 --json >failed.json 2>failed.err || code=$?
  ((code == 1)) && grep -q 'worse than --fail' failed.err || fail "compare --fail 1e-9: exit code $code instead of 1: $(cat failed.err)"
  json_with failed.json scores worst
  "$abn" truth scene:disks --to 40x30 -o small.exr --quiet || fail "truth --to 40x30"
  refused 2 '40x40.*40x30' compare "$work/pictures/exact.exr" "$work/pictures/small.exr"
}

# What points, scene, list and info print and write.
other_verbs() {
  mkdir "$work/other" && cd "$work/other" || exit
  local format
  for format in utk utk-bin psa rps csv; do
    succeeds o.json points --strategy sobol_owen --count 64 --format "$format" -o "p.$format" --json && json_with o.json strategy count seed
    [[ $format != utk-bin && $format != psa ]] && continue
    succeeds o points --strategy "file:p.$format" --count 64 -o again.utk
    cmp -s again.utk p.utk || fail "points come back differently from a $format file than from utk"
  done
  [[ $(wc -l <p.utk) == 64 && $(head -n 1 p.psa) == 64 && $(wc -l <p.csv) == 65 && $(wc -c <p.rps) == 512 ]] || fail "points: wrong number of lines or bytes in a format"
  succeeds o points --strategy sobol_owen --count 4000 --density scene:ramp -o dense.csv
  awk -F, 'NR > 1 && $1 > .5 { ++right } END { exit !(right > 2900 && right < 3100) }' dense.csv || fail "points --density: a ramp must put 3/4 of the points into the right half"
  [[ $("$abn" points --strategy jitter --count 5 -o /dev/stdout --format utk 2>/dev/null | wc -l) == 5 ]] || fail "points -o /dev/stdout: more than the points on stdout"
  succeeds o points --strategy random --count 3000 --density size:step:3 --picture dots.png -o step.csv
  awk -F, 'NR > 1 && $1 < .5 { ++left } END { exit !(left > 2600 && left < 2800) }' step.csv || fail "points --density size:step:3: 9/10 of the points belong into the left half"
  [[ -s dots.png ]] || fail "points --picture wrote no picture"
  succeeds analysis.json analyze --strategy jitter --count 256 --sets 3 --json -o analysis
  json_with analysis.json set spectrum effective_nyquist oscillation low_power peak peak_frequency largest_axis_power largest_axis_frequency axis spacing \
    relative_radius order discrepancy star counts integration half_plane gaussian disc mean standard_error averaged_spectrum skipped
  if command -v python3 >/dev/null; then
    python3 -c 'import json, sys; [json.load(open(name)) for name in sys.argv[1:]]' analysis.json analysis/analysis.json || fail "analyze: its JSON does not parse"
  fi
  for file in analysis.json points.png spectrum.png radial.png pair_correlation.png sheet.png; do [[ -s analysis/$file ]] || fail "analyze -o did not write $file"; done
  succeeds file.txt analyze p.utk && grep -q '^p.utk: 1 set of 64 points' file.txt && grep -q 'half_plane' file.txt || fail "analyze of a file: $(head -n 3 file.txt)"
  ! grep -qiw 'nan' file.txt || fail "analyze of a file prints NaN"
  "$abn" points --strategy jitter --count 256 --quiet -o j.utk
  succeeds j.json analyze j.utk --json
  succeeds k.json analyze --strategy jitter --count 256 --sets 1 --json
  [[ $(sed 's/"set":{[^}]*}*//; s/.*"spectrum"/"spectrum"/; s/,"run".*//' j.json) == "$(sed 's/.*"spectrum"/"spectrum"/; s/,"run".*//' k.json)" ]] || fail "analyze: a file and the strategy it came from give different numbers"
  succeeds scene.json scene ramp --size 7 -o ramp.png --json && json_with scene.json width height hash
  [[ $(number scene.json width) == 7 ]] || fail "scene --size 7 is $(number scene.json width) wide"
  succeeds lhs list strategies lhs && { grep -q '^name *nrooks' lhs || fail "list strategies lhs does not name nrooks"; }
  grep -q '^cite' lhs && grep -q 'default' lhs || fail "list strategies lhs: no citation or no defaults"
  succeeds list.json --json list && json_with list.json strategies scenes filters reconstructions metrics
  succeeds info.json info --json && json_with info.json version revision compiler cpu libraries data_folders
  (cd / && "$abn" downscale scene:apple --to 10x10 --strategy jitter --quiet) >o || fail "downscale scene:apple from /"
  mkdir -p "$work/data/experiments" && cp "$in/many.toml" "$work/data/experiments/mine.toml"
  ABN_DATA=$work/data "$abn" run mine --dry-run >o 2>&1 || fail "ABN_DATA: its experiment is not found: $(cat o)"
  ABN_DATA=relative refused 2 'ABN_DATA.*absolute' downscale scene:apple --strategy jitter

  # --backend auto says in one line that it fell back, where there was something to fall back from; --backend cuda never does.
  local engine=(downscale scene:smooth --to 20x20 --spp 4 --no-cache)
  succeeds o "${engine[@]}" --strategy sph_blue_noise
  [[ ! -s o.err || ($(wc -l <o.err) == 1 && $(<o.err) == *"no CUDA device; the CPU does it all"*) ]] || fail "--backend auto: $(cat o.err)"
  succeeds o "${engine[@]}" --strategy sph_blue_noise --backend cpu
  [[ ! -s o.err ]] || fail "--backend cpu: $(cat o.err)"
  succeeds o "${engine[@]}" --strategy jitter
  [[ ! -s o.err ]] || fail "jitter, which has no engine: $(cat o.err)"
  succeeds o "${engine[@]}" --strategy jitter --reconstruction kriging
  [[ ! -s o.err || ($(wc -l <o.err) == 1 && $(<o.err) == *"no CUDA device; the CPU does it all"*) ]] || fail "kriging and --backend auto: $(cat o.err)"
  succeeds o "${engine[@]}" --strategy sph_blue_noise --quiet
  [[ ! -s o.err ]] || fail "--quiet and --backend auto: $(cat o.err)"
}

# Experiments: stopped, killed, cut in shards, resumed.
experiments() {
  mkdir "$work/runs" && cd "$work/runs" || exit
  cat >tiny.toml <<'TOML'
name = "tiny"
scenes = ["scene:ramp"]
to = "24x24"
spp = [2, 4]
seeds = 5
images = true
metrics = ["rmse", "mae"]
[[strategy]]
name = "jitter"
[[strategy]]
name = "sph_blue_noise"
label = "SPH, 5 iterations"
set = { iterations = 5 }
TOML
  rows() { wc -l <"$1/runs.jsonl"; }
  without_times() { # the CSV of a folder without the columns that no two runs share; header first, rows sorted
    sed 's/"[^"]*"/quoted/g' "$1/runs.csv" | awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; ++i) drop[i] = $i ~ /^time\./ } { for (i = 1; i <= NF; ++i) if (drop[i]) $i = "" } 1' |
      { read -r header && echo "$header" && sort; }
  }
  same_rows() { [[ $(without_times "$1") == "$(without_times "$2")" ]] || fail "$3: not the rows of the uninterrupted run"; }
  succeeds plan run tiny.toml --dry-run
  [[ $(wc -l <plan) == 20 && ! -e results ]] || fail "run --dry-run: $(wc -l <plan) runs instead of 20, or a results folder"
  succeeds table run tiny.toml
  whole=results/runs/tiny
  [[ $(rows $whole) == 20 && -s $whole/table.md && -s $whole/images/ramp_truth.exr && -s $whole/overview_ramp_1152.png ]] ||
    fail "run into its default folder: $(find results -maxdepth 3 | tr '\n' ' ')"
  [[ $(ls $whole/images | wc -l) == 26 ]] || fail "run: $(ls $whole/images | wc -l) pictures instead of 26"
  grep -q 'SPH, 5 iterations' table || fail "run: the table lacks a strategy"
  head -n 1 $whole/runs.csv | grep -q '^experiment,key,label,.*,params\.iterations,.*,scores\.rmse,scores\.mae,time\.generate_s,.*,build\.libraries\.opencv,' ||
    fail "runs.csv: its columns are not the dotted keys: $(head -n 1 $whole/runs.csv)"
  [[ $(sed 's/.*"key":"\([^"]*\)".*"rmse":\([^,}]*\).*/\1 \2/' $whole/runs.jsonl) == "$(sed 's/"[^"]*"/quoted/' $whole/runs.csv | awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "scores.rmse") column = i; next } { print $2, $column }')" ]] || fail "runs.csv and runs.jsonl have different rows"
  succeeds o run tiny.toml --resume --json
  [[ ! -s o && $(rows $whole) == 20 ]] || fail "run --resume of a finished experiment did $(wc -l <o) runs again"
  cp -r $whole cut
  sed -i '$ s/.\{60\}$//' cut/runs.jsonl # a line as a crash leaves it
  succeeds o run tiny.toml --out cut --resume --json
  [[ $(wc -l <o) == 1 ]] || fail "run --resume after a cut-off last line did $(wc -l <o) runs instead of 1"
  same_rows cut $whole "a cut-off last line"
  succeeds o run tiny.toml --out shards --shard 0/2 --json
  head -n 1 o >row.json
  json_with row.json experiment key strategy scores time build
  succeeds o run tiny.toml --out shards --shard 1/2 --resume
  same_rows shards $whole "two shards"
  succeeds o run tiny.toml --out cut --overwrite --seeds 1 --set 'SPH, 5 iterations.iterations=2'
  [[ $(rows cut) == 4 && $(grep -c '"iterations":"2"' cut/runs.jsonl) == 2 ]] || fail "run --overwrite --seeds 1 --set: $(rows cut) rows"

  stopped() { # SIGNAL CODE: stops a run in the middle, and resumes it
    local folder=stopped_$1 code=0 process
    "$abn" run tiny.toml --out "$folder" >"$folder.out" 2>"$folder.err" &
    process=$!
    for ((i = 0; i < 1000; ++i)); do
      [[ -f $folder/runs.jsonl ]] && (($(rows "$folder") >= 3)) && break
      sleep 0.01
    done
    kill "-$1" "$process" || fail "SIG$1: the run had ended already"
    wait "$process" 2>/dev/null || code=$?
    ((code == $2)) || fail "SIG$1: exit code $code instead of $2: $(cat "$folder.err")"
    (($(rows "$folder") >= 3 && $(rows "$folder") < 20)) || fail "SIG$1: $(rows "$folder") rows are kept, it was stopped after 3 of 20"
    [[ $1 != INT ]] || grep -q 'rows are kept.*--resume' "$folder.err" || fail "SIGINT: no word on what is kept: $(cat "$folder.err")"
    succeeds o run tiny.toml --out "$folder" --resume
    same_rows "$folder" $whole "SIG$1 and --resume"
    [[ $(ls "$folder/images") == "$(ls $whole/images)" ]] || fail "SIG$1 and --resume: not all pictures are there"
  }
  stopped INT 130
  { stopped KILL 137; } 2>/dev/null # bash reports the kill
  # Close looks: crops, the errors inside them, estimated errors, and the samples.
  cat >close.toml <<'TOML'
name = "close"
scenes = ["scene:zone_plate"]
to = "40x40"
spp = 2
seeds = 2
images = true
reconstruction = "kriging"
crops = ["fine_rings", "centre"]
zoom = 6
sample_pictures = true
metrics = ["rmse"]
[[strategy]]
name = "jitter"
[[strategy]]
name = "random"
TOML
  succeeds table run close.toml --out close --no-cache
  for file in overview.png crops_centre.png crops_fine_rings.png images/zone_plate_3200_jitter_samples.png \
    images/zone_plate_3200_random_samples_centre.png images/zone_plate_3200_random_estimated.exr; do
    [[ -s close/$file ]] || fail "run with crops and sample pictures wrote no $file: $(ls close close/images | tr '\n' ' ')"
  done
  [[ $(grep -c '"regions":{"fine_rings":0\.[0-9]*,"centre":0\.' close/runs.jsonl) == 4 ]] || fail "run: rows without the errors inside the crops"
  [[ $(grep -c '"calibration":{"rmse_ratio":' close/runs.jsonl) == 4 ]] || fail "run: rows without the calibration of estimated errors"
  head -n 1 close/runs.csv | grep -q ',regions\.fine_rings,regions\.centre,' || fail "runs.csv lacks the columns of the crops"
  grep -q 'region .* RMSE inside' table && grep -q '^| centre' table && grep -q 'estimated / true' table || fail "run: the table lacks crops: $(cat table)"
  rm close/crops_centre.png
  succeeds o run close.toml --out close --resume --json
  [[ ! -s o && -s close/crops_centre.png ]] || fail "run --resume of a finished experiment did not draw its crops again"
  succeeds o run close.toml --out close --overwrite --seeds 1 --quiet
  cat >sets.toml <<'TOML'
kind = "points"
name = "sets"
counts = [64, 100]
seeds = 4
images = true
metrics = ["relative_radius", "empty_cells"]
[[strategy]]
name = "jitter"
[[strategy]]
name = "halton"
[sweep]
halton.scramble = ["none", "owen"]
halton.domain = ["plane", "pixel"]
TOML
  succeeds plan run sets.toml --dry-run
  [[ $(wc -l <plan) == 40 ]] || fail "run --dry-run of point sets: $(wc -l <plan) runs instead of 40"
  succeeds table run sets.toml --out sets
  [[ $(rows sets) == 40 && $(ls sets/points | wc -l) == 40 && -s sets/overview_64.png && -s sets/map_64_halton_relative_radius.png ]] ||
    fail "run of point sets: $(rows sets) rows, $(ls sets sets/points | tr '\n' ' ')"
  grep -q 'scramble=owen domain=pixel .* ± ' table || fail "run of point sets: the table lacks a swept strategy: $(cat table)"
  cp -r sets sets_cut
  sed -i '$ s/.\{60\}$//' sets_cut/runs.jsonl
  rm sets_cut/overview_64.png
  succeeds o run sets.toml --out sets_cut --resume --json
  [[ $(wc -l <o) == 1 && -s sets_cut/overview_64.png ]] || fail "run --resume of point sets did $(wc -l <o) runs instead of 1, or no overview"
  same_rows sets_cut sets "point sets, a cut-off last line"

  "$abn" run "$in/many.toml" --json >/dev/full 2>o.err
  code=$?
  ((code == 3 && $(wc -l <o.err) == 1)) || fail "run --json >/dev/full: exit code $code instead of 3: $(cat o.err)"
}

list_is_quick
examples &
experiments &
other_verbs &
(refusals; full_disks; pictures) &
wait
awk -v a="$EPOCHREALTIME" -v b="$began" 'BEGIN { printf "program_test.sh: %.1f s\n", a - b }'
if [[ -s $failures ]]; then
  cat "$failures" >&2
  echo "program_test.sh: $(grep -c '^FAILED' "$failures") checks failed" >&2
  exit 1
fi
echo "program_test.sh: all checks passed"
