//! Robots with loops as texts.

/// Gravity in the plane of planar loops, whose axes are along z.
pub const IN_PLANE: &str = "[0, -9.81, 0]";
/// Gravity along the axes.
pub const NORMAL: &str = "[0, 0, -9.81]";

/// Ground 1, crank 0.3, coupler 0.9, rocker 0.7.
pub fn four_bar(gravity: &str) -> String {
    format!(
        "name = \"four-bar\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.3, r = 0, active = false }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 1, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"2\", \"3\"]\nat = [[0.9, 0, 0], [0.7, 0, 0]]\ncut = \"revolute\"\n"
    )
}

/// Ground 0.8, cranks 0.4, couplers 0.6.
pub fn five_bar(gravity: &str) -> String {
    format!(
        "name = \"five-bar\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.4, r = 0, active = false }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 0.8, r = 0 }},\n\
         {{ name = \"4\", alpha = 0, d = 0.4, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"2\", \"4\"]\nat = [[0.6, 0, 0], [0.6, 0, 0]]\ncut = \"revolute\"\n"
    )
}

/// A parallelogram of sides 1 and 0.5; `near` chooses between its two branches.
pub fn parallelogram(near: &str) -> String {
    format!(
        "name = \"parallelogram\"\ngravity = {IN_PLANE}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.5, r = 0, active = false }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 1, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"2\", \"3\"]\nat = [[1, 0, 0], [0.5, 0, 0]]\ncut = \"revolute\"\n{near}\n"
    )
}

/// The four-bar cut at the joint between crank and coupler.
pub fn four_bar_cut_at_the_crank(gravity: &str) -> String {
    format!(
        "name = \"four-bar cut elsewhere\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"3\", antecedent = \"base\", alpha = 0, d = 1, r = 0, active = false }},\n\
         {{ name = \"2\", alpha = 0, d = 0.7, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"1\", \"2\"]\nat = [[0.3, 0, 0], [0.9, 0, 0]]\ncut = \"revolute\"\n"
    )
}

/// The four-bar cut at the joint between rocker and ground.
pub fn four_bar_cut_at_the_ground(gravity: &str) -> String {
    format!(
        "name = \"four-bar cut at the ground\"\ngravity = {gravity}\n\
         link = [\n\
         {{ name = \"1\", alpha = 0, d = 0, r = 0 }},\n\
         {{ name = \"2\", alpha = 0, d = 0.3, r = 0, active = false }},\n\
         {{ name = \"3\", alpha = 0, d = 0.9, r = 0, active = false }},\n\
         ]\n\
         [[loop]]\nbetween = [\"3\", \"base\"]\nat = [[0.7, 0, 0], [1, 0, 0]]\ncut = \"revolute\"\n"
    )
}

/// A robot whose couples are replaced by a loop, the joints that follow being passive.
pub fn loop_instead_of_couples(catalogue: &str, passive: &[&str], closure: &str) -> String {
    let tree = catalogue.split("[[couple]]").next().expect("a robot");
    let mut text = tree.to_owned();
    for joint in passive {
        let name = format!("name = \"{joint}\"");
        text = text.replace(&name, &format!("{name}\nactive = false"));
    }
    format!("{text}\n[[loop]]\n{closure}\n")
}

/// A waist that carries a four-bar of unequal sides, its crank driven.
pub fn waist_with_four_bar() -> String {
    "name = \"waist with a four-bar\"\n\
     link = [\n\
     { name = \"waist\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"crank\", alpha = \"-90 deg\", d = 0.1, r = 0 },\n\
     { name = \"coupler\", alpha = 0, d = 0.25, r = 0, active = false },\n\
     { name = \"rocker\", antecedent = \"waist\", alpha = \"-90 deg\", d = 0.55, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"coupler\", \"rocker\"]\nat = [[0.6, 0, 0], [0.5, 0, 0]]\ncut = \"revolute\"\n"
        .to_owned()
}

/// Four links whose axes meet in one point.
pub fn spherical_four_bar() -> String {
    "name = \"spherical 4R\"\ngravity = [1, -2, -9]\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = \"35 deg\", d = 0, r = 0, active = false },\n\
     { name = \"3\", antecedent = \"base\", alpha = \"80 deg\", d = 0, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"2\", \"3\"]\ncut = \"revolute\"\n\
     frames = [{ rpy = [\"75 deg\", 0, 0] }, { rpy = [\"60 deg\", 0, 0] }]\n"
        .to_owned()
}

/// Crank and rocker about skew axes, joined by a rod with two spherical joints; the rod
/// spins freely.
pub fn rssr() -> String {
    "name = \"RSSR\"\ngravity = [0, -9.81, 0]\n\
     link = [\n\
     { name = \"crank\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"s1\", alpha = 0, d = 0.2, r = 0.1, active = false, massless = true },\n\
     { name = \"s2\", alpha = \"90 deg\", d = 0, r = 0, active = false, massless = true },\n\
     { name = \"rod\", alpha = \"90 deg\", d = 0, r = 0, active = false },\n\
     { name = \"rocker\", antecedent = \"base\", alpha = \"50 deg\", d = 0.8, r = 0.3, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"rod\", \"rocker\"]\nat = [[0, 0, 0.9], [0.6, 0, 0.1]]\ncut = \"spherical\"\n"
        .to_owned()
}

/// Bennett's loop: opposite links are equal, sin(alpha)/a = sin(beta)/b. It moves although
/// four revolute joints leave a spatial loop no freedom in general.
pub fn bennett() -> String {
    "name = \"Bennett\"\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = \"30 deg\", d = 0.5, r = 0, active = false },\n\
     { name = \"3\", antecedent = \"base\", alpha = \"90 deg\", d = 1, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"2\", \"3\"]\ncut = \"revolute\"\n\
     frames = [{ xyz = [1, 0, 0], rpy = [\"90 deg\", 0, 0] }, { xyz = [0.5, 0, 0], rpy = [\"30 deg\", 0, 0] }]\n"
        .to_owned()
}

/// Three driven arms, rods with universal joints at both ends, a platform.
pub fn delta() -> String {
    let mut links = String::new();
    let mut closures = String::new();
    for leg in 1..=3 {
        let turn = 120 * (leg - 1);
        links += &format!(
            "[[link]]\nname = \"arm{leg}\"\nantecedent = \"base\"\ngamma = \"{turn} deg\"\nalpha = \"90 deg\"\nd = 0.2\nr = 0\n\
             [[link]]\nname = \"cross{leg}\"\nalpha = 0\nd = 0.3\nr = 0\nactive = false\nmassless = true\n\
             [[link]]\nname = \"rod{leg}\"\nalpha = \"90 deg\"\nd = 0\nr = 0\nactive = false\n"
        );
        if leg > 1 {
            let side = if leg == 2 { "-" } else { "" };
            let at = format!("[-0.075, 0, \"{side}0.05*sqrt(3)/2\"]");
            closures += &format!(
                "[[loop]]\nbetween = [\"rod{leg}\", \"platform\"]\ncut = \"universal\"\n\
                 frames = [{{ xyz = [0.6, 0, 0] }}, {{ xyz = {at}, rpy = [0, \"{turn} deg\", 0] }}]\n"
            );
        }
    }
    format!(
        "name = \"Delta\"\n{links}\
         [[link]]\nname = \"cross4\"\nantecedent = \"rod1\"\nalpha = 0\nd = 0.6\nr = 0\nactive = false\nmassless = true\n\
         [[link]]\nname = \"platform\"\nalpha = \"-90 deg\"\nd = 0\nr = 0\nactive = false\n{closures}"
    )
}

/// A platform on six legs: universal joint, driven length, spherical joint.
pub fn stewart() -> String {
    let base = [-15, 15, 105, 135, 225, 255];
    let platform = [
        [0.0, 0.0, 0.0],
        [-0.1, 0.22, -0.05],
        [-0.4, 0.3, -0.02],
        [-0.62, 0.05, -0.05],
        [-0.45, -0.25, -0.01],
        [-0.18, -0.28, -0.05],
    ];
    let mut links = String::new();
    let mut closures = String::new();
    for (leg, turn) in base.iter().enumerate() {
        let leg = leg + 1;
        links += &format!(
            "[[link]]\nname = \"u{leg}\"\nantecedent = \"base\"\ngamma = \"{turn} deg\"\nalpha = \"90 deg\"\nd = 0.5\nr = 0\nactive = false\nmassless = true\n\
             [[link]]\nname = \"v{leg}\"\nalpha = \"90 deg\"\nd = 0\nr = 0\ntheta = \"90 deg\"\nactive = false\n\
             [[link]]\nname = \"leg{leg}\"\njoint = \"prismatic\"\nalpha = \"90 deg\"\nd = 0\ntheta = 0\nr = 0.8\n"
        );
        if leg == 1 {
            continue;
        }
        let at = platform[leg - 1];
        closures += &format!(
            "[[loop]]\nbetween = [\"leg{leg}\", \"platform\"]\ncut = \"spherical\"\nat = [[0, 0, 0], {at:?}]\n"
        );
    }
    // The platform's frame has its origin at the first leg's joint.
    format!(
        "name = \"Stewart\"\n{links}\
         [[link]]\nname = \"s1\"\nantecedent = \"leg1\"\nalpha = 0\nd = 0\nr = 0\nactive = false\nmassless = true\n\
         [[link]]\nname = \"s2\"\nalpha = \"90 deg\"\nd = 0\nr = 0\nactive = false\nmassless = true\n\
         [[link]]\nname = \"platform\"\nalpha = \"90 deg\"\nd = 0\nr = 0\nactive = false\n{closures}"
    )
}

/// [`waist_with_four_bar`] cut between crank and coupler.
pub fn waist_cut_elsewhere() -> String {
    "name = \"waist, cut elsewhere\"\n\
     link = [\n\
     { name = \"waist\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"crank\", alpha = \"-90 deg\", d = 0.1, r = 0 },\n\
     { name = \"rocker\", antecedent = \"waist\", alpha = \"-90 deg\", d = 0.55, r = 0, active = false },\n\
     { name = \"coupler\", alpha = 0, d = 0.5, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"coupler\", \"crank\"]\nat = [[0.6, 0, 0], [0.25, 0, 0]]\ncut = \"revolute\"\n"
        .to_owned()
}

/// [`spherical_four_bar`] cut at the ground.
pub fn spherical_cut_elsewhere() -> String {
    "name = \"spherical 4R, cut elsewhere\"\ngravity = [1, -2, -9]\n\
     link = [\n\
     { name = \"1\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"2\", alpha = \"35 deg\", d = 0, r = 0, active = false },\n\
     { name = \"3\", alpha = \"75 deg\", d = 0, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"3\", \"base\"]\ncut = \"revolute\"\n\
     frames = [{ rpy = [\"-60 deg\", 0, 0] }, { rpy = [\"80 deg\", 0, 0] }]\n"
        .to_owned()
}

/// [`rssr`] with the rod on the rocker.
pub fn rssr_cut_elsewhere() -> String {
    "name = \"RSSR, cut elsewhere\"\ngravity = [0, -9.81, 0]\n\
     link = [\n\
     { name = \"crank\", alpha = 0, d = 0, r = 0 },\n\
     { name = \"rocker\", antecedent = \"base\", alpha = \"50 deg\", d = 0.8, r = 0.3, active = false },\n\
     { name = \"s1\", alpha = 0, d = 0.6, r = 0.1, active = false, massless = true },\n\
     { name = \"s2\", alpha = \"90 deg\", d = 0, r = 0, active = false, massless = true },\n\
     { name = \"rod\", alpha = \"90 deg\", d = 0, r = 0, active = false },\n\
     ]\n\
     [[loop]]\nbetween = [\"rod\", \"crank\"]\nat = [[0, 0, 0.9], [0.2, 0, 0.1]]\ncut = \"spherical\"\n"
        .to_owned()
}

/// The built-in Delta robot with its third rod on the platform, cut at the elbow.
pub fn delta_cut_elsewhere(catalogue: &str) -> String {
    let third = |name: &str| {
        catalogue
            .find(&format!("[[link]]\nname = \"{name}\""))
            .expect("a link")
    };
    let (from, to) = (third("cross3"), third("cross4"));
    let second_loop = catalogue.rfind("[[loop]]").expect("a loop");
    let passive = "active = false\n";
    format!(
        "{}{}\n[[link]]\nname = \"cross5\"\nmassless = true\n{passive}\
         xyz = [-0.075, 0, \"0.05*sqrt(3)/2\"]\nrpy = [0, \"240 deg\", 0]\n\
         [[link]]\nname = \"rod3\"\n{passive}alpha = \"90 deg\"\nd = 0\ntheta = 0\nr = 0\n\
         {}\n[[loop]]\nbetween = [\"arm3\", \"rod3\"]\ncut = \"universal\"\n\
         at = [[0.3, 0, 0], [0.6, 0, 0]]\n",
        &catalogue[..from],
        &catalogue[to..catalogue.find("[[loop]]").expect("a loop")],
        &catalogue[catalogue.find("[[loop]]").expect("a loop")..second_loop]
    )
}
