#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: demo-page.sh DATASET FOLDER
# Writes FOLDER/index.html about what demo.sh left in FOLDER. All links are relative: the folder can be moved.
set -euo pipefail
data=$1 out=$2
mapfile -t training < <(awk -F'\t' '$2 == "train" { print $1 }' "$data/folds/1.tsv")

for name in "${training[@]}"; do
    cp "$data/images/$name.jpg" "$out/training/$name.jpg"
    cp "$data/labels/$name.png" "$out/training/$name.labels.png"
done

# number KEY: a number at the top level of the result, which is indented by one space; number KEY initial: of the object named so.
number() {
    awk -v key="\"$1\":" -v inside="${2-}" '
        inside != "" && $0 ~ "^ \"" inside "\": \\{" { within = 1; next }
        within && /^ }/ { within = 0 }
        $1 == key && (inside != "" ? within : /^ "/) { sub(/,$/, "", $2); print ($2 == int($2)) ? $2 : sprintf("%.2f", $2); exit }
    ' "$out/learning.json"
}
escape() { sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g'; }
legend() {
    awk -F'\t' '!/^# / && NF == 3 { printf "<span><i style=\"background:%s\"></i>%s</span>\n", $3, $2 }' "$data/classes.tsv"
}

pairs() {
    local name
    for name in "${training[@]:0:15}"; do
        printf '<figure><img src="training/%s.jpg" alt="photograph %s"><img src="training/%s.labels.png" alt="its label map"></figure>\n' \
            "$name" "$name" "$name"
    done
}
lattices() {
    local name
    for name in "${training[@]:0:12}"; do
        printf '<figure><img src="lattices/%s.png" alt="lattice of %s"></figure>\n' "$name" "$name"
    done
}
samples() {
    local file
    for file in "$out"/samples/*.rgb.png; do
        printf '<figure><img src="samples/%s" alt="sampled facade"></figure>\n' "$(basename "$file")"
    done
}

rendered() {
    local file
    for file in "$out"/rendered/images/*.jpg; do
        printf '<figure><img src="rendered/images/%s" alt="sampled facade, rendered"></figure>\n' "$(basename "$file")"
    done
}

# A row a photograph that was parsed: its accuracies are those of the objects of the result, one after the other.
accuracies() { # KEY
    awk -v key="\"$1\":" '$1 == key && /^  "/ { sub(/,$/, "", $2); printf "%.1f\n", 100 * $2 }' "$out/parsed.json"
}
mapfile -t parsed < <(for file in "$out"/parsed/*.overlay.png; do basename "$file" .overlay.png; done)
parses() {
    local name i=0 map parse
    mapfile -t map < <(accuracies map_accuracy)
    mapfile -t parse < <(accuracies accuracy)
    for name in "${parsed[@]}"; do
        cp "$data/images/$name.jpg" "$out/parsed/$name.jpg"
        printf '<div class="row parse">\n'
        printf '<figure><img src="parsed/%s.jpg" alt="photograph %s"><figcaption>photograph</figcaption></figure>\n' "$name" "$name"
        printf '<figure><img src="unaries/%s.png" alt="its pixels one by one"><figcaption>pixels alone: %s %%</figcaption></figure>\n' "$name" "${map[i]}"
        printf '<figure><img src="parsed/%s.png" alt="its parse"><figcaption>parse: %s %%</figcaption></figure>\n' "$name" "${parse[i]}"
        printf '<figure><img src="parsed/%s.overlay.png" alt="the parse over the photograph"><figcaption>overlay</figcaption></figure>\n' "$name"
        printf '<figure><img src="parsed/%s.uncertainty.png" alt="where the parse is uncertain"><figcaption>uncertainty</figcaption></figure>\n</div>\n' "$name"
        i=$((i + 1))
    done
}

cat >"$out/index.html" <<HTML
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Shapegram: a grammar learned from facades</title>
<style>
body{font:16px/1.5 system-ui,sans-serif;color:#1f2430;background:#fafaf8;max-width:1180px;margin:0 auto;padding:2em 1.5em 4em}
h1{font-size:1.9em;line-height:1.2;margin:.2em 0}h2{font-size:1.25em;margin:2.4em 0 .4em;padding-top:.6em;border-top:2px solid #ddd9cf}
p{max-width:46em;margin:.5em 0 1em}code,pre{font:13px/1.5 ui-monospace,monospace;background:#efede6;border-radius:3px}
code{padding:.1em .3em}pre{padding:1em;overflow:auto;max-height:26em}
.row{display:flex;flex-wrap:wrap;gap:10px}figure{margin:0;display:flex;gap:2px;background:#fff;padding:4px;border:1px solid #dcd8cc}
figure img{height:170px;display:block}.parse{margin-bottom:10px}.parse figure{display:block}.parse img{height:250px}
figcaption{font-size:13px;color:#555;padding-top:2px}.big img{height:200px}.legend{margin:.6em 0 1em}.legend span{margin-right:1.2em;white-space:nowrap}
.legend i{display:inline-block;width:.9em;height:.9em;margin-right:.4em;border:1px solid #0003;vertical-align:-.08em}
table{border-collapse:collapse;margin:1em 0}td,th{padding:.25em 1.2em .25em 0;text-align:right;border-bottom:1px solid #e2dfd5}
td:first-child,th:first-child{text-align:left}.drawing{background:#fff;border:1px solid #dcd8cc;padding:8px;overflow:auto;max-height:720px}
.drawing img{max-width:none}a{color:#1a5a9a}
</style></head><body>
<h1>A grammar learned from ${#training[@]} facades</h1>
<p>Shapegram looked at the label maps of ${#training[@]} facades, found the lines that all of them follow, wrote each facade down as a
hierarchy of splits, and merged these into one small stochastic grammar. The facades in the last section are new: they are
samples of that grammar.</p>

<h2>1. What it learned from</h2>
<p>Photographs and label maps of the bundled set (<code>data/facades</code>, rendered from a grammar that is known, so that learning can be
checked). Learning sees the label maps only. Here are the first 15 of ${#training[@]}.</p>
<div class="legend">$(legend)</div>
<div class="row">
$(pairs)
</div>

<h2>2. Lattices</h2>
<p><code>make-lattice</code> lays lines over each map so that the cells between them show it with as few wrong pixels as their number is
worth. What the lattices cannot show, nothing that follows can learn.</p>
<pre>$(tail -n 1 "$out/log/lattices.txt" | tr -s ' ' | escape)</pre>
<div class="row">
$(lattices)
</div>

<h2>3. The grammar</h2>
<p><code>learn-grammar</code> starts from a grammar that makes exactly the training facades, and merges symbols and rules as long as
the energy (description length, and how well the grammar explains the facades) falls: here $(number merges) merges, in $(number seconds) s.
The <a href="report/index.html">report</a> has the whole history.</p>
<table>
<tr><th></th><th>initial</th><th>learned</th></tr>
<tr><td>energy (nats)</td><td>$(number initial_energy)</td><td>$(number energy)</td></tr>
<tr><td>symbols</td><td>$(number nonterminals initial)</td><td>$(number nonterminals)</td></tr>
<tr><td>rules that split along x</td><td>$(number rules_x initial)</td><td>$(number rules_x)</td></tr>
<tr><td>rules that split along y</td><td>$(number rules_y initial)</td><td>$(number rules_y)</td></tr>
</table>
<p>A card for each symbol, with what its rules make (also as a <a href="graph.svg">plain graph</a>, as <a href="grammar.sg">text</a>, and as it was
<a href="initial.sg">at the beginning</a>):</p>
<div class="drawing"><img src="report/grammar.svg" alt="the grammar"></div>

<h2>4. New facades</h2>
<p>28 samples: <code>sample-grammar grammar.sg -n 28</code>. Each was made by choosing rules by their probabilities and the sizes of their parts
by the densities that were fitted to the training facades.</p>
<div class="row big">
$(samples)
</div>
<p>And 14 more as photographs, by the program that made the bundled set:</p>
<div class="row big">
$(rendered)
</div>

<p>A street of new ones, in space: <code>street.sg</code> <a href="street/street.sg">imports</a> the learned grammar and gives each of its
labels a body, with windows behind the wall and balconies before it. The model is there for other
programs, as <a href="street/street-0001.obj">OBJ</a> and as <a href="street/street-0001.glb">glTF</a>.</p>
<figure class="drawing"><img src="street/street-0001.render.png" alt="a street of sampled facades, as a model in space"></figure>

<h2>5. Photographs, parsed</h2>
<p>These facades took no part in learning. <code>learn-unaries</code> trained a random forest on the ${#training[@]} training photographs, which says
of each pixel what it may be; <code>parse-facade</code> looked for the derivation of the grammar that explains all pixels of a photograph together, by
Markov chains that change rules and sizes (8 chains at rising temperatures, 2 runs of 50 000 iterations each). The per cent are of pixels that are
right. Uncertain is where samples of the posterior disagree. Each parse is a derivation, too, with every rectangle and the rule it
comes from (<a href="parsed/${parsed[0]}.json">the first one's</a>), and can be changed or sampled from like any other.</p>
<div class="legend">$(legend)</div>
$(parses)
</body></html>
HTML
for file in "$out"/report/grammar.svg "$out"/graph.svg; do [ -s "$file" ] || { echo "$file is missing" >&2; exit 1; }; done
