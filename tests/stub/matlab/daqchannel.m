% Stands in for a channel of the Data Acquisition Toolbox in tests.
classdef daqchannel < handle
  properties
    Range = [0 0];
  end
end
