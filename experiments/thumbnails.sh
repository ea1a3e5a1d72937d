#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Thumbnails and gallery of the example grammars: docs/pictures/grammars/NAME.png, 240 by 240 pixels, of each
# data/grammars/NAME.sg, and docs/grammars.md, which says what they are, as their first comment does, and how large their
# derivations are.
# usage: thumbnails.sh             makes what pictures are missing, and the gallery
#        thumbnails.sh NAME...     makes the pictures of these grammars anew, and the gallery
#        thumbnails.sh --gallery   prints the gallery
# pngquant, where it is installed, makes the pictures less than half as large, as those that are kept are.
# SG_BUILD_DIR: where the programs are (build); SG_SAMPLES: how many samples' sizes the gallery has (9)
set -eu
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
sample=$(cd "${SG_BUILD_DIR:-build}" && pwd)/src/sample-grammar
grammars=$root/data/grammars
pictures=$root/docs/pictures/grammars
samples=${SG_SAMPLES:-9} # of each grammar, for the sizes in the gallery
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT

# NAME SEED AZIMUTH,ELEVATION of samples that show what a grammar is about; seed 1 and the view 35,18 of those that are not
# listed. Grammars of labels have no view.
choices() {
    cat <<'END'
acacia 2 30,4
airplane 5 35,18
branching 2 0,8
building 11 35,14
city 8 35,26
conifer 2 30,8
fern 4 20,22
furniture 4 35,18
ga-city 4 35,28
ga-tree 10 20,10
lilac 2 15,12
low-rise 6 35,18
mondrian 7
old-oak 24 30,6
poplar 2 30,6
skyscraper 6 35,18
spaceship 2 35,26
street 1 -40,16
sunflower 1 10,8
three-rules 5 0,6
toy 3 35,18
weber-penn 2 25,10
willow 22 20,2
young-oak 1 30,6
END
}
choice() { # NAME
    choices | awk -v name="$1" 'BEGIN { seed = 1; view = "35,18" } $1 == name { seed = $2; view = $3 } END { print seed, view }'
}

# The picture of labels, or where a grammar makes none the model in space.
picture() { # NAME
    local seed view options
    read -r seed view <<<"$(choice "$1")"
    options=(-n 1 --seed "$seed" --size 240x240 --name thumbnail --quiet -o "$work")
    rm -f "$work"/thumbnail*
    "$sample" "$grammars/$1.sg" "${options[@]}" --formats rgb 2>/dev/null ||
        "$sample" "$grammars/$1.sg" "${options[@]}" --formats render --view="${view:-35,18}"
    if command -v pngquant >/dev/null; then pngquant --force --ext .png 256 "$work"/thumbnail*.png; fi
    mv "$work"/thumbnail*.png "$pictures/$1.png"
    echo "docs/pictures/grammars/$1.png"
}

# The first sentence of the first comment, and those of its first two paragraphs that name a source.
about() { # NAME
    awk 'NR == 1 { next }
         !/^#/ { exit }
         { sub(/^# ?/, "") }
         /^$/ { paragraphs++; next }
         paragraphs < 2 { text = text (text == "" ? "" : " ") $0 }
         END {
             n = split(text, sentence, /\. /)
             for (i = 1; i <= n; i++)
                 if (i == 1 || sentence[i] ~ /^(After|Source)|[^0-9](19|20)[0-9][0-9][^0-9]/)
                     line = line (i == 1 ? "" : " ") sentence[i] (i < n ? "." : "")
             print line
         }' "$grammars/$1.sg" | sed 's/[][|*_<`\\]/\\&/g'
}

# Median, least and greatest number in the columns symbols, parameters and depth.
sizes() { # NAME
    "$sample" "$grammars/$1.sg" -n "$samples" --table - --quiet >"$work/table"
    local column
    for column in symbols parameters depth; do
        awk -F '\t' -v want="$column" -v n="$samples" '
            NR == 1 { for (i = 1; i <= NF; i++) if ($i == want) at = i; next }
            NR <= n + 1 { print $at }' "$work/table" | sort -n | awk '
            { v[NR] = $1 }
            END { printf v[1] == v[NR] ? " %d |" : " %d (%d-%d) |", v[int((NR + 1) / 2)], v[1], v[NR] }'
    done
}

gallery() {
    cat <<END
# Example grammars

The grammars in \`data/grammars\` (installed as \`share/shapegram/grammars\`). Each file says what its parameters mean. The
sizes are those that \`sample-grammar --stats\` tells: median, and least and greatest where they differ, of $samples samples. This
page and its pictures are made by \`experiments/thumbnails.sh\`.

| | grammar | what it makes | symbols | parameters | depth |
|---|---|---|---|---|---|
END
    local file name
    for file in "$grammars"/*.sg; do
        name=$(basename "$file" .sg)
        printf '| ![%s](pictures/grammars/%s.png) | [%s.sg](../data/grammars/%s.sg) | %s |%s\n' "$name" "$name" "$name" "$name" \
            "$(about "$name")" "$(sizes "$name")"
    done
}

if [ "${1-}" = --gallery ]; then
    gallery
    exit
fi
mkdir -p "$pictures"
if [ $# = 0 ]; then
    for file in "$grammars"/*.sg; do
        name=$(basename "$file" .sg)
        if ! [ -e "$pictures/$name.png" ]; then picture "$name"; fi
    done
else
    for name; do picture "$name"; done
fi
gallery >"$work/gallery"
cp "$work/gallery" "$root/docs/grammars.md"
echo docs/grammars.md
