#!/usr/bin/env bats
# The appearance of the atlas in the window: by commands of scripts, by keys, and by the mouse over a cut.
load helpers
load window

# phantoms: nested balls, which are also the context.
phantoms() {
    conus phantom nested -o . --size 32
}

@test "words and keys change how it looks, and sessions keep it" {
    phantoms
    view nested.nii.gz --context nested.nii.gz --pathway nested.nii.gz,name=Tract,threshold=0.5 <<'END'
save before.json
grey 1 2
opacity "Shell outer" 0.5
opacity 0.25
haze Tract own
preset heat
background black
save words.json
open before.json
save again.json
key b
key ]
key }
key ,
key k
save keys.json
open words.json
save words2.json
grey
opacity 1
opacity "Shell outer" reset
haze Tract solid
preset
background light
save reset.json
END
    [ "$(jq -c '[.look, .preset, .background]' words.json)" = '[{"grey":[1,2],"opacities":[[1,0.5]],"opacity_of_the_rest":0.25,"pathways":[[4,"own"]]},"heat","black"]' ]
    diff words.json words2.json
    diff before.json again.json
    diff <(jq .look before.json) <(jq .look reset.json)
    # a step is a twentieth of the first window upwards, and a tenth of its logarithm in contrast
    jq -e '.look.opacity_of_the_rest == 0.9 and .background == "light" and .look.grey[0] < .look.grey[1]' keys.json
}

@test "the mouse drags grey values over a cut, and resets them" {
    phantoms
    live nested.nii.gz --context nested.nii.gz
    look '.look.grey == null'
    crosshair=$(jq -c .crosshair "look$looks.json")
    xdotool mousemove --window "$window" 305 48
    look true
    xdotool mousedown 2
    look true
    xdotool mousemove --window "$window" 325 48 # more contrast: the same middle
    until look '.look.grey != null'; do :; done
    width=$(jq '.look.grey[1] - .look.grey[0]' "look$looks.json")
    black=$(jq '.look.grey[0]' "look$looks.json")
    xdotool mouseup 2
    look true
    xdotool keydown ctrl mousedown 1
    look true
    xdotool mousemove --window "$window" 325 80 # darker: the same width
    until look ".look.grey[0] > $black"; do :; done
    look "(.look.grey[1] - .look.grey[0]) / $width | . > 0.999999 and . < 1.000001"
    xdotool mouseup 1
    look true
    until look '.look.grey == null'; do # two clicks with frames between them
        xdotool click --repeat 2 --delay 10 1
    done
    xdotool keyup ctrl
    look ".crosshair == $crosshair"
    xdotool key --window "$window" ctrl+z
    until look '.look.grey != null'; do :; done
    leave
}

@test "streamlines are coloured by words and a key, in figures, too, and sessions keep it" {
    conus phantom slabs -o . --size 32
    python3 "$BATS_TEST_DIRNAME/tck.py" two.tck -40,30,0 40,30,0 -- 0,30,-40 0,30,40
    view slabs.nii.gz --streamlines two.tck <<'END'
sheet pixels 100 80
figure bundle.png
streamline-colour direction
figure direction.png
save words.json
key 9
figure again.png
save key.json
open words.json
save words2.json
END
    [ "$(jq -c .look.streamline_colour words.json key.json | tr '\n' ' ')" = '"direction" "bundle" ' ]
    diff words.json words2.json
    cmp bundle.png again.png
    not cmp -s bundle.png direction.png
}
