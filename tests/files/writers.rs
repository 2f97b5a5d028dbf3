//! B-splines as files. The writers are as small as the formats allow and share nothing with the readers.

use splinepost::geom::nurbs::Nurbs;

type Writer = fn(&[Nurbs]) -> String;

/// A name of each format, and its writer.
pub(super) const WRITERS: &[(&str, Writer)] = &[("c.dxf", dxf), ("c.igs", iges), ("c.stp", step)];

/// A DXF file of pairs, in units of `$INSUNITS` 4.
pub(super) fn drawing(entities: &str) -> String {
    format!(
        "  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n 70\n4\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n{entities}  0\nENDSEC\n  0\nEOF\n"
    )
}

/// A drawing with blocks of a name and one entity each.
pub(super) fn with_blocks(blocks: &[(&str, &str)], entities: &str) -> String {
    let block = |(name, text): &(&str, &str)| {
        format!(
            "{}{}{}",
            entity(&format!("BLOCK 8=0 2={name} 70=0 10=0 20=0")),
            entity(text),
            entity("ENDBLK 8=0")
        )
    };
    let section = format!(
        "  0\nSECTION\n  2\nBLOCKS\n{}  0\nENDSEC\n",
        blocks.iter().map(block).collect::<Vec<_>>().concat()
    );
    let text = drawing(entities);
    text.replacen("  0\nSECTION\n  2\nENTITIES", &format!("{section}  0\nSECTION\n  2\nENTITIES"), 1)
}

/// Pairs from `LINE 10=1 20=2`: what stands first has code 0.
pub(super) fn entity(text: &str) -> String {
    let mut out = String::new();
    for (i, word) in text.split_whitespace().enumerate() {
        let (code, value) = if i == 0 { ("0", word) } else { word.split_once('=').expect("code=value") };
        out.extend([format!("{code:>3}\n{value}\n")]);
    }
    out
}

pub(super) fn dxf(splines: &[Nurbs]) -> String {
    let mut entities = String::new();
    for spline in splines {
        let flags = if spline.is_polynomial() { 8 } else { 12 };
        let (p, knots, points) = (spline.degree(), spline.knots(), spline.points());
        let mut text = format!("SPLINE 8=0 70={flags} 71={p} 72={} 73={}", knots.len(), points.len());
        text.extend(knots.iter().map(|t| format!(" 40={t:?}")));
        text.extend(spline.weights().iter().map(|w| format!(" 41={w:?}")));
        text.extend(points.iter().map(|p| format!(" 10={:?} 20={:?} 30={:?}", p[0], p[1], p[2])));
        entities.push_str(&entity(&text));
    }
    drawing(&entities)
}

/// A number as IGES and STEP write it: with a point, and E for the exponent.
fn real(x: f64) -> String {
    let text = format!("{x:E}");
    let (mantissa, exponent) = text.split_once('E').expect("an exponent");
    let point = if mantissa.contains('.') { "" } else { "." };
    format!("{mantissa}{point}E{exponent}")
}

/// An IGES file: kind, form, transformation, status and parameters of each entity, in mm.
pub(super) fn model(entities: &[(u32, u32, usize, &str, String)]) -> String {
    let global =
        "1H,,1H;,1HA,1HA,1HA,1HA,32,38,6,308,15,1HA,1.,2,2HMM,1,0.01,1HA,1.E-7,100.,1HA,1HA,11,0,1HA;";
    let (mut directory, mut data) = (Vec::new(), Vec::new());
    for (i, (kind, form, matrix, status, parameters)) in entities.iter().enumerate() {
        let first = data.len() + 1;
        let record = format!("{kind},{parameters};");
        let mut line = String::new();
        for word in record.split_inclusive([',', ';']) {
            if 64 < line.len() + word.len() {
                data.push(format!("{line:64}{:8}", 2 * i + 1));
                line.clear();
            }
            line.push_str(word);
        }
        data.push(format!("{line:64}{:8}", 2 * i + 1));
        directory.push(format!("{kind:8}{first:8}{:8}{:8}{:8}{:8}{matrix:8}{:8}{status}", 0, 0, 0, 0, 0));
        let lines = data.len() + 1 - first;
        directory.push(format!("{kind:8}{:8}{:8}{lines:8}{form:8}{:32}", 0, 0, ""));
    }
    let global: Vec<String> =
        global.as_bytes().chunks(72).map(|chunk| String::from_utf8_lossy(chunk).into_owned()).collect();
    let mut out = String::new();
    for (section, lines) in [
        ('S', vec!["test".to_owned()]),
        ('G', global),
        ('D', directory),
        ('P', data),
        ('T', vec![String::new()]),
    ] {
        for (i, line) in lines.iter().enumerate() {
            out.extend([format!("{line:72}{section}{:7}\n", i + 1)]);
        }
    }
    out
}

pub(super) fn iges(splines: &[Nurbs]) -> String {
    let entity = |spline: &Nurbs| {
        let (p, knots, points) = (spline.degree(), spline.knots(), spline.points());
        let mut numbers: Vec<f64> = knots.to_vec();
        numbers.extend(spline.weights());
        numbers.extend(points.iter().flat_map(|p| p[..3].iter().copied()));
        numbers.extend([knots[p], knots[points.len()], 0.0, 0.0, 1.0]);
        let numbers: Vec<String> = numbers.into_iter().map(real).collect();
        let text = format!(
            "{},{p},0,0,{},0,{}",
            points.len() - 1,
            u8::from(spline.is_polynomial()),
            numbers.join(",")
        );
        (126, 0, 0, "00000000", text)
    };
    model(&splines.iter().map(entity).collect::<Vec<_>>())
}

/// A STEP file of these instances, in mm and radians.
pub(super) fn exchange(instances: &str) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));\nENDSEC;\nDATA;\n{instances}\
         #900=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #901=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #903=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.54),#904);\n\
         #904=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));\n\
         #910=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#900,#901))REPRESENTATION_CONTEXT('',''));\n\
         ENDSEC;\nEND-ISO-10303-21;\n"
    )
}

pub(super) fn step(splines: &[Nurbs]) -> String {
    let mut text = String::new();
    let mut next = 1000;
    for spline in splines {
        let mut names = Vec::new();
        for p in spline.points() {
            text.extend([format!(
                "#{next}=CARTESIAN_POINT('',({},{},{}));\n",
                real(p[0]),
                real(p[1]),
                real(p[2])
            )]);
            names.push(format!("#{next}"));
            next += 1;
        }
        let (mut times, mut knots): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
        for t in spline.knots() {
            if knots.last() == Some(t) {
                *times.last_mut().expect("a knot") += 1;
            } else {
                knots.push(*t);
                times.push(1);
            }
        }
        let list = |all: Vec<String>| all.join(",");
        let times = list(times.iter().map(ToString::to_string).collect());
        let knots = list(knots.into_iter().map(real).collect());
        let (p, names) = (spline.degree(), names.join(","));
        let head = format!("{p},({names}),.UNSPECIFIED.,.F.,.F.");
        let instance = if spline.is_polynomial() {
            format!("#{next}=B_SPLINE_CURVE_WITH_KNOTS('',{head},({times}),({knots}),.UNSPECIFIED.);\n")
        } else {
            let weights = list(spline.weights().iter().map(|w| real(*w)).collect());
            format!(
                "#{next}=(BOUNDED_CURVE()B_SPLINE_CURVE({head})B_SPLINE_CURVE_WITH_KNOTS(({times}),({knots}),.UNSPECIFIED.)\
                 CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(({weights}))REPRESENTATION_ITEM(''));\n"
            )
        };
        text.push_str(&instance);
        next += 1;
    }
    exchange(&text)
}
