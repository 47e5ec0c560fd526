% Stands in for the Data Acquisition Toolbox in tests: what was written goes to the file STUB_LOG,
% inputs follow the output. STUB_FAIL, STUB_TRIP: number of the sample at which something happens;
% STUB_STOP: it does not stop; STUB_RATE: that it has instead of the one that is asked.
classdef daq < handle
  properties
    Rate = 0;
    played = [];
    at = 0;
    inputs = 0;
  end
  methods
    function this = daq(vendor)
      stub_log(['daq ', vendor]);
    end
    function c = addoutput(this, device, terminal, type)
      stub_log(['output ', device, '/', terminal, ' ', type]);
      if ~isempty(getenv('STUB_RATE'))
        this.Rate = str2double(getenv('STUB_RATE'));
      end
      c = daqchannel();
    end
    function c = addinput(this, device, terminal, type)
      stub_log(['input ', device, '/', terminal, ' ', type]);
      this.inputs = this.inputs + 1;
      c = daqchannel();
    end
    function preload(this, data)
      this.played = data;
      stub_log(sprintf('queued %d %.9g %.9g', numel(data), sum(data), data(end)));
    end
    function start(this)
      stub_log(sprintf('start %g', this.Rate));
    end
    function stop(this)
      stub_log('stop');
      if ~isempty(getenv('STUB_STOP'))
        error('the device does not stop');
      end
    end
    function delete(this)
      stub_log('delete');
    end
    function write(this, volts)
      stub_log(sprintf('write %.9g', volts));
    end
    function data = read(this, count, varargin)
      last = this.at + count;
      if last > str2double(getenv('STUB_FAIL'))
        error('the device was taken away');
      end
      index = (this.at:last - 1)';
      before = [0; this.played];
      before = before(index + 1);
      current = 0.01 + 1.99 * (index >= str2double(getenv('STUB_TRIP')));
      data = [before, current, 0.05 * before .^ 2];
      data = data(:, 1:this.inputs);
      this.at = last;
    end
  end
end
