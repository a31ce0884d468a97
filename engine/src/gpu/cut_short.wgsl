// Whether loops of this invocation were cut short. Software Vulkan ends all loops of an invocation after 65 535 turns in all
// (Mesa, LP_MAX_TGSI_LOOP_ITERATIONS), without a word; a loop that begins then ends after its first turn. `turns` is 2, and comes
// from a buffer so that no compiler knows it.
fn cut_short(turns: u32) -> bool {
    var turn = 0u;
    while turn < turns {
        turn++;
    }
    return turn < turns;
}
