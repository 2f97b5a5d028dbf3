//! Every statement of the language, a row each: what is said about it, and a fixture that shows it.
//!
//! `read`: it does what it says, or changes nothing that is compiled. `warned`: it is left out, and a warning says so.
//! `refused`: the file is not compiled, with the reason.

use super::intent_as;
use splinepost::dump;

/// What becomes of a statement: the steps that it makes (a part of the dump), or the id of the diagnostic.
#[derive(Debug)]
enum Becomes {
    Read(&'static str),
    Warned(&'static str),
    Refused(&'static str),
}
use Becomes::{Read, Refused, Warned};

const HEAD: &str = "UNITS/MM\nLOADTL/1\nFEDRAT/100,MMPM\nSPINDL/500,RPM,CLW\nRAPID\nGOTO/0,0,10\n";
/// A statement behind the first move, or with `^` before all else.
fn fixture(statement: &str) -> String {
    match statement.strip_prefix('^') {
        Some(statement) => format!("{statement}\n{}{TAIL}", HEAD.trim_start_matches("UNITS/MM\n")),
        None => format!("{HEAD}{statement}\n{TAIL}"),
    }
}

const TAIL: &str = "GOTO/1,0,0\nFINI\n";

/// System, statement, what becomes of it.
const TABLE: &[(&str, &str, Becomes)] = &[
    // frame
    ("iso", "PARTNO PLATE 7", Read("program PLATE_7")),
    ("iso", "PARTNO/PLATE", Read("comment PARTNO PLATE")),
    ("iso", "PPRINT A (REMARK) WITH $ AND 50%", Read("comment A [REMARK] WITH $ AND 50pct")),
    ("solidworks", "PPRINT/'TEXT, QUOTED'", Read("comment TEXT, QUOTED")),
    ("iso", "INSERT M98 P1", Refused("insert")),
    ("iso", "MACHIN/MILL,1,2", Warned("word-left-out")),
    ("catia", "REWIND/0", Warned("word-left-out")),
    ("iso", "UNITS/CM", Warned("units-change")),
    ("iso", "^UNITS/CM", Read("X 0.0 Y 0.0 Z 100.0")),
    ("iso", "^UNITS/FEET", Read("Z 3047.9999999999995")),
    ("iso", "^UNITS/INCHES", Read("X 0.0 Y 0.0 Z 254.0")),
    ("iso", "UNITS/PARSEC", Refused("units")),
    ("solidworks", "UNIT/MM", Read("")),
    ("fusion", "MODE/MILL", Read("")),
    ("fusion", "MODE/TURN", Refused("turning")),
    ("iso", "MODE/INCR", Refused("arguments")),
    ("iso", "STOP", Read("\nstop\n")),
    ("iso", "STOP/FOO", Refused("arguments")),
    ("iso", "OPSTOP", Read("\noptional stop\n")),
    ("nx", "TOOL PATH/ROUGH,TOOL,EM 10", Read("comment TOOL PATH ROUGH,TOOL,EM 10")),
    ("nx", "END-OF-PATH", Warned("word-left-out")),
    ("catia", "SYN/'A','B'", Warned("word-left-out")),
    ("catia", "PPFUN/3,1", Refused("word-refused")),
    ("nx", "PAINT/COLOR,186", Warned("word-left-out")),
    ("iso", "END", Refused("moves-after-end")), // what follows it is
    ("iso", "GOTO/1,0,0\nEND\nPPRINT ALL DONE\nREWIND/0", Refused("moves-after-end")),
    // tool
    ("iso", "CUTTER/16,0,8,4.6,30,0,50", Read("comment CUTTER 16,0,8,4.6,30,0,50")),
    ("nx", "TLDATA/MILL,10,0.5,75,0,0", Read("comment TLDATA MILL,10,0.5,75,0,0")),
    ("nx", "TLDATA/DRILL,MILL,8,0,100,118,60", Read("comment TLDATA DRILL,MILL,8,0,100,118,60")),
    ("nx", "TLDATA/WEDM,0.2,10,0", Refused("wire")),
    ("catia", "TOOLNO/1,20.0,3.0,,120.0", Read("comment TOOLNO 1,20.0,3.0,,120.0")),
    ("catia", "TOOLNO/1,TURN,1,0,3", Refused("turning")),
    ("catia", "TPRINT/T1 Drill D 10", Read("comment T1 Drill D 10")),
    ("iso", "LOADTL/4\nSPINDL/ON\nRAPID\nGOTO/0,0,10", Read("\ntool 4\nspindle 500\n")),
    ("iso", "LOADTL/4\nSPINDL/ON", Warned("cut-first")),
    ("iso", "LOADTL/0\nSPINDL/ON", Refused("tool-zero")),
    ("iso", "LOADTL/4", Warned("spindle-missing")),
    ("iso", "COOLNT/ON\nLOADTL/4\nSPINDL/ON\nRAPID\nGOTO/0,0,10", Read("\ntool 4\nspindle 500\n")),
    ("iso", "LOADTL/4,1,LENGTH,100", Warned("tool-arguments")),
    ("iso", "^RAPID\nGOTO/0,0,90\nLOADTL/4", Warned("moves-before-tool")),
    ("iso", "LOADTL/4\nLOADTL/4", Warned("tool-repeated")),
    ("iso", "LOADTL/1.5", Refused("tool-number")),
    (
        "iso",
        "LOADTL/4,OSETNO,9\nSPINDL/ON\nRAPID\nGOTO/0,0,10",
        Read("\ntool 4 with the length of register 9\n"),
    ),
    ("iso", "LOADTL/4,OSETNO,0", Refused("tool-register")),
    ("iso", "TOOLNO/4,OSETNO,9", Refused("tool-register")),
    ("nx", "LOAD/TOOL,4\nSPINDL/ON\nRAPID\nGOTO/0,0,10", Read("\ntool 4\nspindle 500\n")),
    ("nx", "LOAD/WIRE", Refused("wire")),
    ("iso", "SELCTL/5", Warned("word-left-out")),
    ("nx", "SELECT/TOOL,5", Warned("word-left-out")),
    ("iso", "TURRET/2,OSETNO,1,SETOOL,0,0,0", Refused("word-refused")),
    ("iso", "OFSTNO/FIXTUR,3", Refused("word-refused")),
    // technology
    ("catia", "SPINDL/2546.4790,RPM,CLW", Read("\nspindle 2546.479\n")),
    ("nx", "SPINDL/RPM,1500,CLW", Read("\nspindle 1500\n")),
    ("creo", "SPINDL / RPM, 9000.000000,  CLW", Read("\nspindle 9000\n")),
    ("iso", "SPINDL/OFF", Warned("spindle-missing")),
    ("iso", "SPINDL/OFF\nSPINDL/ON", Read("spindle stops\nspindle 500\n")),
    ("iso", "SPINDL/OFF,ON", Refused("arguments")),
    ("iso", "SPINDL/500,600", Refused("arguments")),
    ("iso", "SPINDL/900,CCLW", Refused("spindle-reverse")),
    ("iso", "SPINDL/100,SFM", Refused("cutting-speed")),
    ("iso", "SPINDL/100,SMM", Refused("cutting-speed")),
    ("iso", "SPINDL/900,MAXRPM,5000", Warned("word-left-out")),
    ("iso", "SPINDL/900,RANGE,2", Refused("spindle-range")),
    ("iso", "SPINDL/ORIENT", Refused("spindle-orient")),
    ("fusion", "SPINDL / MAIN", Warned("word-left-out")),
    ("iso", "FEDRAT/200\nGOTO/0,1,0", Read("feed 200 lines")),
    ("iso", "FEDRAT/MMPM,200\nGOTO/0,1,0", Read("feed 200 lines")),
    ("iso", "FEDRAT/0.5,MMPR\nGOTO/0,1,0", Read("feed 250 lines")),
    ("iso", "FEDRAT/10,IPM\nGOTO/0,1,0", Read("feed 254 lines")),
    ("iso", "FEDRAT/0.01,IPR\nGOTO/0,1,0", Read("feed 127 lines")),
    ("iso", "FEDRAT/1,FPM\nGOTO/0,1,0", Read("feed 304.79999999999995 lines")),
    ("iso", "FEDRAT/FPR,0.001\nGOTO/0,1,0", Read("feed 152.39999999999998 lines")),
    ("iso", "FEDRAT/200,300", Refused("arguments")),
    ("iso", "FEDRAT/200,IPM,MMPM", Refused("arguments")),
    ("iso", "FEDRAT/0.5,MMPR\nFEDRAT/200", Refused("feed-unit")),
    ("iso", "FEDRAT/INVERS,AUTO", Refused("feed-inverse")),
    ("iso", "FEDRAT/INVERS,OFF", Read("")),
    ("iso", "FEDRAT/0,MMPM", Refused("feed-range")),
    ("iso", "COOLNT/ON", Read("\ncoolant\n")),
    ("iso", "COOLNT/FLOOD,HIGH", Warned("word-left-out")),
    ("iso", "COOLNT/OFF", Read("\ncoolant stops\n")),
    ("iso", "COOLNT/ON,OFF", Refused("arguments")),
    ("iso", "COOLNT/FLOOD,MIST", Refused("arguments")),
    ("iso", "COOLNT/MIST", Refused("coolant")),
    ("iso", "COOLNT/TAP", Refused("coolant")),
    ("iso", "COOLNT/THRU,HIGH", Refused("coolant")),
    ("iso", "DELAY/1.5", Read("\ndwell 1.5\n")),
    ("iso", "DELAY/1,2", Refused("arguments")),
    ("iso", "DELAY/2,REV", Refused("dwell-revolutions")),
    ("iso", "CUTCOM/OFF", Read("")),
    ("iso", "CUTCOM/LEFT,XYPLAN", Refused("cutter-compensation")),
    ("nx", "CUTCOM/RIGHT,ZXPLAN", Refused("cutter-compensation")),
    ("iso", "CUTCOM/LEFT,5", Refused("cutter-compensation")),
    ("iso", "CUTCOM/ON", Refused("cutter-compensation")),
    ("catia", "INTOL/0.025", Warned("word-left-out")),
    ("catia", "OUTTOL/0.025", Warned("word-left-out")),
    ("iso", "LINTOL/0.1,0.1", Warned("word-left-out")),
    ("catia", "AUTOPS", Warned("word-left-out")),
    ("iso", "AUXFUN/8", Refused("word-refused")),
    ("iso", "PREFUN/54", Refused("word-refused")),
    ("catia", "SWITCH/3", Warned("word-left-out")),
    ("iso", "ROTATE/TABLE,90", Refused("word-refused")),
    ("iso", "ROTABL/90,,TABLE,CLW", Refused("word-refused")),
    ("iso", "ROTHED/90", Refused("word-refused")),
    // axes
    ("catia", "^ORIGIN/0,0,60", Read("comment FRAME ORIGIN 0 0 60\n")),
    ("nx", "MSYS/0,0,20,1,0,0,0,-1,0\nRAPID\nGOTO/0,0,10", Warned("frame-changes")),
    ("nx", "MSYS/0,0,20,1,0,0,0,-1,0", Refused("frame-cut")),
    // The stop stands where the tool is at home anyway.
    ("nx", "MSYS/0,0,20,1,0,0,0,-1,0\nLOAD/TOOL,2\nSPINDL/ON\nRAPID\nGOTO/0,0,10", Warned("frame-changes")),
    ("nx", "^RAPID\nGOTO/0,0,90\nMSYS/0,0,20,1,0,0,0,-1,0", Refused("frame-tool")),
    ("nx", "^MSYS/0,0,20,1,0,0,0,-1,0", Read("comment FRAME MSYS 0 0 20 1 0 0 0 -1 0\n")),
    ("solidworks", "^CSYS/1,0,0,0,0,1,0,0,0,0,1,0", Read("comment FRAME CSYS 1 0 0 0 0 1 0 0 0 0 1 0\n")),
    ("creo", "^$$-> CSYS / 1.0, 0.0, $\n 0.0, 0.0", Read("comment FRAME CSYS 1 0 0 0\n")),
    (
        "catia",
        "^$$*CATIA0\n$$ A\n$$ 1.0 0.0 0.0 5.0\n$$ 0 1 0 0\n$$ 0 0 1 0",
        Read("comment FRAME CATIA0 A 1 0 0 5 0 1 0 0 0 0 1 0"),
    ),
    ("solidworks", "^TRNTYP/WORLD,0,0,0", Read("comment FRAME TRNTYP WORLD 0 0 0\n")),
    ("solidworks", "SETUP/START,1", Read("comment SETUP START,1")),
    ("iso", "MULTAX", Read("")),
    ("iso", "MULTAX/ON", Read("")),
    ("iso", "MULTAX/ON,OFF", Refused("arguments")),
    ("iso", "TLAXIS/0,0,1", Read("")),
    ("iso", "TLAXIS/0,3,4", Refused("tool-axis")),
    ("iso", "TLAXIS/0,0.6,0.8", Read("    X 1.0 Y 0.0 Z 0.0 TX 0.0 TY 0.6 TZ 0.8\n")),
    ("iso", "RAPID\nGOTO/5,0,10,0.6,0,0.8", Read("rapid X 5 TX 0.6 TY 0 TZ 0.8\n")),
    // motion
    ("iso", "RAPID\nGOTO/5,0,10", Read("rapid X 5\n")),
    ("iso", "RAPID /\nGOTO/5,0,10\nGOTO/5,1,10", Read("rapid X 5\ncut as asked feed 100 lines")),
    ("iso", "RAPID/OFF", Refused("arguments")),
    ("iso", "RAPID/5000", Refused("arguments")),
    ("iso", "FROM/1,2,3", Warned("from-late")),
    ("iso", "^FROM/1,2,3,0,0,1", Read("\nrapid X 0 Y 0 Z 10\n")),
    ("iso", "^FROM/1,2,80\nLOADTL/2\nGOHOME", Read("\nrapid X 1 Y 2 Z 80\n")),
    ("iso", "GOHOME/0,0,50", Read("rapid Z 50\n")),
    ("iso", "GOHOME", Refused("home-unknown")),
    ("iso", "GODLTA/1,2,-3", Read("    X 1.0 Y 2.0 Z 7.0\n")),
    ("iso", "GODLTA/-3", Read("    X 0.0 Y 0.0 Z 7.0\n")),
    ("iso", "GOTO/1,2,3,0,0,1", Read("    X 1.0 Y 2.0 Z 3.0\n")),
    ("iso", "GOTO/1,2,3,0,0.6,0.8", Read("    X 1.0 Y 2.0 Z 3.0 TX 0.0 TY 0.6 TZ 0.8\n")),
    // The direction is modal: the next point keeps it.
    ("nx", "GOTO/1,2,3,0,0.6,0.8", Read("    X 1.0 Y 0.0 Z 0.0 TX 0.0 TY 0.6 TZ 0.8\n")),
    ("nx", "GODLTA/5", Read("    X 0.0 Y 0.0 Z 15.0\n")),
    ("creo", "TLAXIS/0,0.6,0.8\nCIRCLE/5,0,10,0,0,1,5\nGOTO/10,0,10", Refused("arc-axis")),
    ("iso", "GOTO/1,2,3,0,0,1,7", Refused("goto-numbers")),
    ("iso", "GOTO/1,2", Refused("goto-numbers")),
    (
        "creo",
        "CIRCLE/5,0,10,0,0,1,5\nGOTO/10,0,10",
        Read("arc Xy CounterClockwise from X 0.0 Y 0.0 Z 10.0 to X 10.0"),
    ),
    ("solidworks", "CIRCLE/5,0,10,0,0,1\nGOTO/10,0,10", Read("arc Xy CounterClockwise")),
    ("nx", "CIRCLE/5,0,10,0,0,1,5,.06,.5,10,0\nGOTO/10,0,10", Read("arc Xy Clockwise")),
    ("fusion", "MOVARC/5,0,10,0,0,1,5,ANGLE,180\nGOTO/10,0,10", Read("arc Xy CounterClockwise")),
    ("catia", "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/5,0,10,5),ON,(LINE/5,0,10,9,0,10)", Read("arc Xy Clockwise")),
    (
        "catia",
        "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/5,0,10,5),ON,2,INTOF,(LINE/5,0,10,0,0,10)",
        Read("arc Xy Clockwise from X 0.0 Y 0.0 Z 10.0 to X 0.0 Y 0.0 Z 10.0"),
    ),
    (
        "catia",
        "INDIRV/0,1,0\nTLON,GOFWD/(CYLNDR/5,0,10,0,0,1,5),ON,(PLANE/PERPTO,(PLANE/(POINT/5,0,10),PERPTO,\
         (VECTOR/0,0,1)),(POINT/5,0,10),(POINT/5,5,10))",
        Read("arc Xy Clockwise from X 0.0 Y 0.0 Z 10.0 to X 5.0 Y 5.0 Z 10.0"),
    ),
    ("catia", "TLON,GOFWD/(CIRCLE/5,0,10,5),ON,(LINE/5,0,10,9,0,10)", Refused("tangent-missing")),
    // in a plane that is tilted about Y, from (−3, 0, −4) to (0, 5, 0) beside the centre
    (
        "creo",
        "CIRCLE/3,0,14,0.8,0,-0.6,5\nGOTO/3,5,14",
        Read("] CounterClockwise from X 0.0 Y 0.0 Z 10.0 to X 3.0 Y 5.0 Z 14.0 about ["),
    ),
    ("solidworks", "CIRCLE/3,0,14,0.8,0,-0.6\nGOTO/3,5,14", Read("arc about [0.8, 0.0, -0.")),
    (
        "nx",
        "CIRCLE/3,0,14,0.8,0,-0.6,5,.06,.5,10,0\nGOTO/3,5,14",
        Read("] Clockwise from X 0.0 Y 0.0 Z 10.0 to X 3.0 Y 5.0 Z 14.0 about ["),
    ),
    ("fusion", "MOVARC/3,0,14,0.8,0,-0.6,5,ANGLE,450\nGOTO/3,5,14", Read(" turns 1.25\n")),
    (
        "catia",
        "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/3,0,14,5),ON,(LINE/3,0,14,3,9,14)",
        Read("arc about [0.8, 0.0, -0.6] CounterClockwise from X 0.0 Y 0.0 Z 10.0 to X "),
    ),
    (
        "catia",
        "INDIRV/0,-1,0\nTLON,GOFWD/(CYLNDR/3,0,14,0.8,0,-0.6,5),ON,(PLANE/PERPTO,(PLANE/(POINT/3,0,14),PERPTO,\
         (VECTOR/0.8,0,-0.6)),(POINT/3,0,14),(POINT/3,5,14))",
        Read("] Clockwise from X 0.0 Y 0.0 Z 10.0 to X "),
    ),
    // the plane of the tangent is not that of the end
    ("catia", "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/3,0,14,5),ON,(LINE/3,0,14,4,9,14)", Refused("arc-plane")),
    ("catia", "PSIS/(PLANE/(POINT/0,0,0),PERPTO,(VECTOR/0,0,1))", Warned("word-left-out")),
    // splines
    ("nx", "NURBS/\nKNOT/1.0\nCNTRL/1,0,10\nCNTRL/2,0,10\nCNTRL/3,0,10", Read("nurbs of degree 3")),
    (
        "catia",
        "BEGIN NURBS_SIEMENS(D=3,F=100,AXIS=VAR,LENGTH=50.0)\nN0,XT=0,YT=0,ZT=10,XH=0,YH=0,ZH=60,DK=0,W=1\n\
         N1,XT=1,YT=0,ZT=10,XH=1,YH=0,ZH=60,DK=0,W=1\nN2,XT=2,YT=0,ZT=10,XH=2,YH=0,ZH=60,DK=3,W=1\n\
         N3,XT=3,YT=0,ZT=10,XH=3,YH=0,ZH=60,DK=0,W=1\nEND NURBS",
        Read("TX 0.0 TY 0.0 TZ 50.0"),
    ),
    ("catia", "FEDRAT/0.1,MMPR\nBEGIN NURBS_SIEMENS(D=3,F=0.1,AXIS=0,0,1)", Refused("nurbs-revolutions")),
    ("catia", "BEGIN NURBS_SIEMENS(D=3,F=100,AXIS=VAR)", Refused("nurbs-header")),
    ("catia", "BEGIN NURBS_SIEMENS(D=3,F=100,AXIS=0.0,0.6,0.8)", Refused("spline-axis")),
    (
        "creo",
        "MOVNRB/M3AXIS,LENGTH,0\nMOVNRB/ON,4,8,0,4,3\nMOVNRB/1,0,0,0,0,1,1,1,1\nMOVNRB/2,0,0,10,1,0,10,2,0,10,3,0,10\nMOVNRB/OFF",
        Read("nurbs of degree 3"),
    ),
    (
        "creo",
        "MOVNRB/5AXIS,LENGTH,50\nMOVNRB/ON,4,8,0,4,3\nMOVNRB/1,0,0,0,0,1,1,1,1\n\
         MOVNRB/2,0,0,10,1,0,10,2,0,10,3,0,10\nMOVNRB/3,0,0,60,1,0,60,2,0,60,3,0,60\nMOVNRB/OFF",
        Read("TX 0.0 TY 0.0 TZ 50.0"),
    ),
    ("creo", "MOVNRB/5AXIS", Refused("nurbs-header")),
    (
        "catia",
        "FEDRAT/0.1,MMPR\nBEGIN NURBS_SIEMENS(D=3,F=0.1,AXIS=0,0,1)\nN0,XT=0,YT=0,ZT=10,DK=0,W=1\nEND NURBS",
        Refused("nurbs-revolutions"),
    ),
    (
        "catia",
        "BEGIN NURBS_SIEMENS(D=3,F=9,AXIS=0,0,1)\nN7,XT=0,YT=0,ZT=10,DK=0,W=1\nN1\nEND NURBS",
        Refused("nurbs-point"),
    ),
    ("nx", "NURBS/\nKNOT/1.0\nCNTRL/1,0\nCNTRL/2,0,10\nCNTRL/3,0,10", Refused("nurbs-order")),
    (
        "nx",
        "CYCLE/DRILL,RAPTO,2,FEDTO,-7,MMPM,50\nGOTO/5,0,0\nNURBS/\nKNOT/1.0\nCNTRL/1,0,10\nCNTRL/2,0,10\nCNTRL/3,0,10",
        Refused("spline-in-cycle"),
    ),
    // cycles
    (
        "creo",
        "CYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,1\nGOTO/5,0,0\nCYCLE/OFF",
        Read("rapid X 5 Y 0 Z 10\nrapid Z 1\ncut as asked feed 50"),
    ),
    ("creo", "CYCLE/OFF", Read("")),
    ("creo", "CYCLE/CLEAR", Read("")),
    ("creo", "CYCLE/ON", Refused("cycle-unknown")),
    ("iso", "CYCLE/INIT", Read("")),
    (
        "creo",
        "CYCLE/DRILL,DEPTH,3,MMPM,50,CLEAR,1\nCYCLE/OFF\nCYCLE/ON\nGOTO/5,0,0\nCYCLE/OFF",
        Read("rapid X 5 Y 0 Z 10\nrapid Z 1\ncut as asked feed 50"),
    ),
    (
        "nx",
        "CYCLE/DRILL,RAPTO,2,FEDTO,-7,RTRCTO,20,MMPM,50\nGOTO/5,0,0\nCYCLE/OFF",
        Read("    X 5.0 Y 0.0 Z -7.0\nrapid Z 20\n"),
    ),
    ("iso", "CYCLE/DRILL,THRU,DEPTH,3,CLEAR,1", Refused("arguments")),
    ("iso", "CYCLE/DRILL,DEPTH,3,DEPTH,4,CLEAR,1", Refused("arguments")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1,RAPTO,2", Refused("arguments")),
    ("iso", "CYCLE/DRILL,DEPTH,3,STEP,1,CLEAR,1", Refused("cycle-step")),
    ("iso", "CYCLE/DEEP,DEPTH,3,CLEAR,1", Refused("cycle-step")),
    ("iso", "CYCLE/DEEP,DEPTH,3,STEP,1,CLEAR,0", Refused("cycle-clear")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,0\nGOTO/5,0,0\nCYCLE/OFF", Warned("cycle-clear")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1,RTRCTO,-5\nGOTO/5,0,0\nCYCLE/OFF", Warned("cycle-retract")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1,RTRCTO,AUTO\nGOTO/5,0,0\nCYCLE/OFF", Read("Z -3.0\nrapid Z 10\n")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1,RTRCTO,AUTO,MANUAL", Refused("arguments")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1,DWELL,-2", Refused("cycle")),
    ("iso", "CYCLE/DRILL,DEPTH,3,CLEAR,1\nGOTO/5,0,0\nGODLTA/5,0,0", Refused("cycle-increment")),
    ("iso", "CYCLE/OFF,5", Refused("arguments")),
    (
        "iso",
        "CYCLE/DRILL,DEPTH,3,CLEAR,1\nCYCLE/ON,CLEAR,7\nGOTO/5,0,0\nCYCLE/OFF",
        Read("Z -3.0\nrapid Z 7\n"),
    ),
    ("creo", "CYCLE/BORE,DEPTH,3,MMPM,50,CLEAR,1", Refused("cycle")),
    ("creo", "CYCLE/TAP,DEPTH,3,MMPM,50,CLEAR,1", Refused("cycle")),
    ("catia", "CYCLE/DRILL, 3.0, 5.0", Refused("cycle-number")),
    ("iso", "CALSUB/SUB1", Refused("word-refused")),
    ("iso", "DEFSUB/SUB1", Refused("word-refused")),
    ("iso", "ENDSUB", Refused("word-refused")),
    ("catia", "PROBE/POINTS,1", Refused("word-refused")),
    ("nx", "SET/UPPER,10,LOWER,0", Refused("word-refused")),
    // what nobody knows
    ("iso", "FROBNI/1", Refused("word-unknown")),
    ("iso", "COOLNT/SOMEHOW", Refused("word-unknown")),
];

#[test]
fn every_statement_is_read_warned_or_refused() {
    let mut wrong = Vec::new();
    for (system, statement, becomes) in TABLE {
        let text = fixture(statement);
        let result = intent_as(system, &text, false);
        let fits = match (&result, becomes) {
            (Ok(intent), Read(part)) => intent.warnings.0.is_empty() && dump::intent(intent).contains(part),
            (Ok(intent), Warned(id)) => intent.warnings.0.iter().any(|d| d.id == *id && d.span.is_some()),
            (Err(errors), Refused(id)) => errors.0.iter().any(|d| d.id == *id && d.span.is_some()),
            _ => false,
        };
        if !fits {
            let shown = result.map(|intent| (dump::intent(&intent), intent.warnings));
            wrong.push(format!("{system}: {statement}\n  {becomes:?}\n  {shown:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// One mistake has one report.
#[test]
fn what_is_refused_is_told_once() {
    for (system, statement, becomes) in TABLE {
        if let Refused(id) = becomes {
            let Err(errors) = intent_as(system, &fixture(statement), false) else {
                continue;
            };
            let stops: Vec<_> = errors
                .0
                .iter()
                .filter(|d| {
                    !matches!(
                        d.id,
                        "word-left-out"
                            | "cycle-open"
                            | "tool-arguments"
                            | "frame-changes"
                            | "moves-before-tool"
                            | "tool-missing"
                    )
                })
                .collect();
            assert_eq!(stops.len(), 1, "{system}: {statement}: {id}: {errors:?}");
        }
    }
}

#[test]
fn lenient_leaves_out_what_nobody_knows() {
    for statement in ["FROBNI/1", "INSERT M98 P1"] {
        let intent = intent_as("iso", &format!("{HEAD}{statement}\n{TAIL}"), true).expect(statement);
        assert_eq!(intent.warnings.0.len(), 1, "{:?}", intent.warnings);
    }
    // What is understood and not compiled is refused all the same; so is what may be another word misspelt, and a word that would
    // say something else without its argument.
    for statement in [
        "CUTCOM/LEFT",
        "ROTABL/90",
        "RAPD",
        "CIRCL/1,2,3",
        "TLAXS/0,1,0",
        "COOLNT/SOMEHOW",
        "SPINDL/500,CCW",
        "FEDRAT/10,IPN",
    ] {
        assert!(intent_as("iso", &format!("{HEAD}{statement}\n{TAIL}"), true).is_err(), "{statement}");
    }
}
